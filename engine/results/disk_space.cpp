#include "engine/results/disk_space.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace quicksand {
namespace {

[[noreturn]] void refuse(int error) {
  throw std::runtime_error("cannot make room for the next frame: " + std::generic_category().message(error));
}

off_t size_of(int file) {
  struct stat status {};
  if (fstat(file, &status) != 0) refuse(errno);
  return status.st_size;
}

}  // namespace

void reserve_space(int file, std::size_t bytes) {
  const off_t size = size_of(file), more = static_cast<off_t>(bytes);
  // Writing past this limit raises a signal that ends the process, so it must not be reached.
  rlimit limit{};
  if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
      static_cast<rlim_t>(size + more) > limit.rlim_cur)
    refuse(EFBIG);
  if (fallocate(file, FALLOC_FL_KEEP_SIZE, size, more) == 0) return;
  if (errno == ENOSPC || errno == EDQUOT || errno == EFBIG || errno == EIO || errno == EROFS) refuse(errno);
}

DiskRefusal disk_refusal(const std::string& message) {
  const auto tells = [&](int reason) {
    return message.find(std::generic_category().message(reason)) != std::string::npos;
  };
  if (tells(ENOSPC) || tells(EDQUOT)) return DiskRefusal::full;
  if (tells(EROFS)) return DiskRefusal::read_only;
  return tells(EFBIG) || tells(EIO) ? DiskRefusal::other : DiskRefusal::none;
}

void release_reserved(int file) {
  if (ftruncate(file, size_of(file)) != 0) refuse(errno);
}

void turn_into_memory(int file) {
  const int memory = memfd_create("discarded", MFD_CLOEXEC);
  if (memory < 0) return;
  dup3(memory, file, O_CLOEXEC);
  close(memory);
}

}  // namespace quicksand
