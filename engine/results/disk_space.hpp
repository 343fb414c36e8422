#pragma once
#include <cstddef>

namespace quicksand {

/// Makes sure that `bytes` more can be appended to the open file, so that a full disk is found out before
/// anything in the file has changed. Throws std::runtime_error with the system's reason ("No space left on
/// device", "File too large", "Disk quota exceeded"). Where a file system cannot reserve, it does nothing.
void reserve_space(int file, std::size_t bytes);

/// Gives back what was reserved past the end of the file.
void release_reserved(int file);

}  // namespace quicksand
