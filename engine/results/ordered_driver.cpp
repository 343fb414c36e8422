#include "engine/results/ordered_driver.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace quicksand {
namespace {

using Bytes = std::vector<unsigned char>;

/// HDF5 wants its own struct in front.
struct OrderedFile {
  H5FD_t base;
  int descriptor;
  haddr_t end;        ///< of what HDF5 has allocated
  haddr_t committed;  ///< the same at the last flush: what lies before may be referred to
  haddr_t stored;     ///< bytes of the file on disk
  struct Held {
    int rank;
    haddr_t at;
    Bytes bytes;
  };
  std::vector<Held> held;  ///< in the order in which they were written
};

OrderedFile& own(H5FD_t* file) { return *reinterpret_cast<OrderedFile*>(file); }
const OrderedFile& own(const H5FD_t* file) { return *reinterpret_cast<const OrderedFile*>(file); }

/// With the system's words where HDF5's own drivers have them.
herr_t refuse(const char* what) {
  const int number = errno;
  H5Epush2(H5E_DEFAULT, __FILE__, __func__, __LINE__, H5E_ERR_CLS, H5E_IO, H5E_WRITEERROR,
           "%s, errno = %d, error message = '%s'", what, number, std::strerror(number));
  return -1;
}

bool write_all(OrderedFile& file, haddr_t at, const unsigned char* bytes, std::size_t count) {
  file.stored = std::max(file.stored, at + count);
  while (count > 0) {
    const ssize_t done = pwrite(file.descriptor, bytes, count, static_cast<off_t>(at));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return false;
    bytes += done;
    at += static_cast<haddr_t>(done);
    count -= static_cast<std::size_t>(done);
  }
  return true;
}

H5FD_t* open(const char* name, unsigned flags, hid_t, haddr_t) {
  int mode = (flags & H5F_ACC_RDWR) != 0 ? O_RDWR : O_RDONLY;
  if ((flags & H5F_ACC_CREAT) != 0) mode |= O_CREAT;
  if ((flags & H5F_ACC_EXCL) != 0) mode |= O_EXCL;
  if ((flags & H5F_ACC_TRUNC) != 0) mode |= O_TRUNC;
  constexpr mode_t permissions = 0666;
  const int descriptor = ::open(name, mode | O_CLOEXEC, permissions);
  struct stat status {};
  if (descriptor < 0 || fstat(descriptor, &status) != 0) {
    refuse("cannot open");
    if (descriptor >= 0) ::close(descriptor);
    return nullptr;
  }
  auto* file = new OrderedFile{};
  file->descriptor = descriptor;
  file->stored = file->committed = static_cast<haddr_t>(status.st_size);
  return &file->base;
}

herr_t close(H5FD_t* file) {
  const int status = ::close(own(file).descriptor);
  delete &own(file);
  return status == 0 ? 0 : refuse("cannot close");
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  struct stat one {
  }, other{};
  fstat(own(a).descriptor, &one);
  fstat(own(b).descriptor, &other);
  if (one.st_dev != other.st_dev) return one.st_dev < other.st_dev ? -1 : 1;
  return one.st_ino < other.st_ino ? -1 : one.st_ino > other.st_ino ? 1 : 0;
}

/// As HDF5's ordinary driver, but for what gathers neighbouring metadata: space for them would be set aside,
/// so that new ones lay before the end. H5Fincrement_filesize asks for SWMR's flag.
herr_t query(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_SUPPORTS_SWMR_IO | H5FD_FEAT_POSIX_COMPAT_HANDLE |
           H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

haddr_t get_end(const H5FD_t* file, H5FD_mem_t) { return own(file).end; }

herr_t set_end(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  own(file).end = end;
  return 0;
}

haddr_t get_stored(const H5FD_t* file, H5FD_mem_t) { return own(file).stored; }

herr_t get_handle(H5FD_t* file, hid_t, void** handle) {
  *handle = &own(file).descriptor;
  return 0;
}

/// What was never written is zero.
herr_t read(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t at, std::size_t count, void* to) {
  const OrderedFile& file = own(base);
  auto* bytes = static_cast<unsigned char*>(to);
  for (std::size_t have = 0; have < count;) {
    const ssize_t done = pread(file.descriptor, bytes + have, count - have, static_cast<off_t>(at + have));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return refuse("cannot read");
    if (done == 0) {
      std::fill(bytes + have, bytes + count, static_cast<unsigned char>(0));
      break;
    }
    have += static_cast<std::size_t>(done);
  }
  for (const auto& [rank, held_at, held] : file.held) {
    const haddr_t first = std::max(at, held_at), last = std::min(at + count, held_at + held.size());
    if (first < last) std::memcpy(bytes + (first - at), held.data() + (first - held_at), last - first);
  }
  return 0;
}

/// First the heading, as the file must not be longer than it says; then names, to which indices will refer,
/// and last what counts (extents, NSteps). What is equal keeps its order, which for metadata is that of
/// addresses: an index comes before its older parts.
int rank_of(H5FD_mem_t type) {
  constexpr int heading = 0, names = 1, others = 2, counts = 3;
  if (type == H5FD_MEM_SUPER) return heading;
  if (type == H5FD_MEM_LHEAP) return names;
  return type == H5FD_MEM_OHDR ? counts : others;
}

herr_t write(H5FD_t* base, H5FD_mem_t type, hid_t, haddr_t at, std::size_t count, const void* from) {
  OrderedFile& file = own(base);
  const auto* bytes = static_cast<const unsigned char*>(from);
  const std::size_t before =
      at >= file.committed ? 0 : static_cast<std::size_t>(std::min<haddr_t>(count, file.committed - at));
  if (before > 0) file.held.push_back({rank_of(type), at, Bytes(bytes, bytes + before)});
  if (before == count || write_all(file, at + before, bytes + before, count - before)) return 0;
  return refuse("cannot write");
}

/// The file as long as its heading will say, then what is held.
herr_t flush(H5FD_t* base, hid_t, hbool_t) {
  OrderedFile& file = own(base);
  if (file.stored < file.end) {
    if (ftruncate(file.descriptor, static_cast<off_t>(file.end)) != 0) return refuse("cannot lengthen");
    file.stored = file.end;
  }
  std::stable_sort(file.held.begin(), file.held.end(),
                   [](const auto& a, const auto& b) { return a.rank < b.rank; });
  for (const auto& [rank, at, bytes] : file.held)
    if (!write_all(file, at, bytes.data(), bytes.size())) return refuse("cannot write");
  file.held.clear();
  if (file.stored > file.end) {
    if (ftruncate(file.descriptor, static_cast<off_t>(file.end)) != 0) return refuse("cannot shorten");
    file.stored = file.end;
  }
  file.committed = file.end;
  return 0;
}

/// Left to `flush`, which HDF5 calls next.
herr_t truncate(H5FD_t*, hid_t, hbool_t) { return 0; }

constexpr H5FD_class_t driver{
    .name = "ordered",
    .maxaddr = static_cast<haddr_t>(std::numeric_limits<off_t>::max()),
    .fc_degree = H5F_CLOSE_WEAK,
    .terminate = nullptr,
    .sb_size = nullptr,
    .sb_encode = nullptr,
    .sb_decode = nullptr,
    .fapl_size = 0,
    .fapl_get = nullptr,
    .fapl_copy = nullptr,
    .fapl_free = nullptr,
    .dxpl_size = 0,
    .dxpl_copy = nullptr,
    .dxpl_free = nullptr,
    .open = open,
    .close = close,
    .cmp = compare,
    .query = query,
    .get_type_map = nullptr,
    .alloc = nullptr,
    .free = nullptr,
    .get_eoa = get_end,
    .set_eoa = set_end,
    .get_eof = get_stored,
    .get_handle = get_handle,
    .read = read,
    .write = write,
    .flush = flush,
    .truncate = truncate,
    .lock = nullptr,
    .unlock = nullptr,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};

}  // namespace

bool use_ordered_driver(hid_t file_access) {
  static const hid_t id = H5FDregister(&driver);
  return id >= 0 && H5Pset_driver(file_access, id, nullptr) >= 0;
}

}  // namespace quicksand
