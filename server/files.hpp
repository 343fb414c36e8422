#pragma once
#include <filesystem>
#include <optional>
#include <string>

namespace quicksand {

/// What this process creates from now on is for its own user alone.
void make_private();

/// Whole text file; empty when it cannot be read.
std::optional<std::string> read_text(const std::filesystem::path& file);

/// Replaces `file` in one step: after a crash it holds the old text or the new one. Throws
/// std::runtime_error with the file's name when the disk refuses.
void write_atomically(const std::filesystem::path& file, const std::string& text);

/// An open file descriptor for reading at any place, safe to share between threads.
class ReadOnlyFile {
 public:
  /// Throws std::runtime_error when it cannot be opened.
  explicit ReadOnlyFile(const std::filesystem::path& file);
  ~ReadOnlyFile();
  ReadOnlyFile(const ReadOnlyFile&) = delete;
  ReadOnlyFile& operator=(const ReadOnlyFile&) = delete;
  std::size_t size() const { return size_; }  ///< bytes when it was opened
  /// Reads up to `count` bytes at `offset`; 0 at the end or on error.
  std::size_t read(char* bytes, std::size_t count, std::size_t offset) const;

 private:
  int descriptor_;
  std::size_t size_ = 0;
};

}  // namespace quicksand
