#include "server/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace quicksand {
namespace {

bool write_all(int descriptor, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = ::write(descriptor, text.data() + done, text.size() - done);
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return ::fsync(descriptor) == 0;
}

}  // namespace

void make_private() { ::umask(0077); }

std::optional<std::string> read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file)) return {};
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void write_atomically(const std::filesystem::path& file, const std::string& text) {
  const std::string part = file.string() + ".part";
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) throw std::runtime_error("cannot create " + file.filename().string());
  const bool written = write_all(descriptor, text);
  if (::close(descriptor) != 0 || !written || ::rename(part.c_str(), file.c_str()) != 0) {
    ::unlink(part.c_str());
    throw std::runtime_error("cannot write " + file.filename().string());
  }
}

ReadOnlyFile::ReadOnlyFile(const std::filesystem::path& file)
    : descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) throw std::runtime_error("cannot open " + file.filename().string());
  struct stat facts {};
  if (::fstat(descriptor_, &facts) == 0) size_ = static_cast<std::size_t>(facts.st_size);
}

ReadOnlyFile::~ReadOnlyFile() { ::close(descriptor_); }

std::size_t ReadOnlyFile::read(char* bytes, std::size_t count, std::size_t offset) const {
  const ssize_t got = ::pread(descriptor_, bytes, count, static_cast<off_t>(offset));
  return got > 0 ? static_cast<std::size_t>(got) : 0;
}

}  // namespace quicksand
