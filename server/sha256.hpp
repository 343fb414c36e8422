#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace quicksand {

/// SHA-256 as 64 lower-case hexadecimal digits.
std::string sha256_text(std::string_view bytes);

/// SHA-256 of a file, read in constant memory. Throws std::runtime_error with the file's name when it
/// cannot be read.
std::string sha256_file(const std::filesystem::path& file);

}  // namespace quicksand
