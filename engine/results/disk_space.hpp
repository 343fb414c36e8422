#pragma once
#include <cstddef>
#include <string>

namespace quicksand {

/// Makes sure that `bytes` more can be appended to the open file, so that a full disk is found out before
/// anything in the file has changed. Throws std::runtime_error with the system's reason ("No space left on
/// device", "File too large", "Disk quota exceeded"). Where a file system cannot reserve, it does nothing.
void reserve_space(int file, std::size_t bytes);

/// Why the disk refused, by the system's words in an error's text.
enum class DiskRefusal { none, full, read_only, other };
DiskRefusal disk_refusal(const std::string& message);

/// Gives back what was reserved past the end of the file.
void release_reserved(int file);

/// Lets `file` refer to memory from now on: what is on disk stays as it is, and every later write succeeds
/// and is forgotten. For a library that goes on writing when it is told to give up a file.
void turn_into_memory(int file);

}  // namespace quicksand
