#include "engine/results/kill_safe_file.hpp"

#include <unistd.h>

#include <stdexcept>

#include "engine/results/disk_space.hpp"
#include "engine/results/ordered_driver.hpp"

namespace quicksand {
namespace {

// A frame dirties some 100 kB of metadata. What is kept of older frames takes several times as much memory as
// in the file, so that it must not grow.
constexpr std::size_t metadata_cache_bytes = 1024 * 1024;
// Half the entries of a symbol-table leaf (40 bytes each) and of a tree node: a frame's arrays fit one leaf,
// and /frames seldom splits one, which is the moment when a kill could cost names of older frames.
constexpr unsigned group_leaf_k = 16, group_tree_k = 16;
// Room for the names in a long group (8 bytes each), so that their heap does not move as it grows.
constexpr std::size_t long_group_bytes = 16 * 1024;

h5::Handle file_access(const std::string& what) {
  h5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, what);
  // The oldest format: the newer ones mark the file as open, and after a kill it could not be opened again.
  h5::check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_EARLIEST, H5F_LIBVER_LATEST), what);
  h5::check(H5Pset_file_locking(access.get(), false, true), what);  // others may read what is flushed
  H5AC_cache_config_t cache{};
  cache.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  h5::check(H5Pget_mdc_config(access.get(), &cache), what);
  cache.set_initial_size = true;
  cache.initial_size = metadata_cache_bytes;
  cache.max_size = cache.min_size = metadata_cache_bytes;
  cache.decr_mode = H5C_decr__off;
  h5::check(H5Pset_mdc_config(access.get(), &cache), what);
  if (!use_ordered_driver(access.get())) throw h5::Error(what);
  return access;
}

}  // namespace

KillSafeFile KillSafeFile::open(const std::string& path) {
  const std::string what = "cannot open the file";
  h5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, file_access(what).get()), H5Fclose, what);
  // A kill within a flush can leave objects behind the end that the file knows of.
  h5::check(H5Fincrement_filesize(file.get(), 0), "cannot go on with the file");
  return KillSafeFile(std::move(file));
}

KillSafeFile KillSafeFile::create(const std::string& path) {
  const std::string what = "cannot create the file";
  const h5::Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, what);
  h5::check(H5Pset_sym_k(creation.get(), group_tree_k, group_leaf_k), what);
  h5::check(H5Pset_obj_track_times(creation.get(), false), what);
  const h5::Handle access = file_access(what);
  return KillSafeFile(
      h5::Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose, what));
}

h5::Handle KillSafeFile::create_long_group(const char* name) const {
  const std::string what = std::string("cannot create group ") + name;
  const h5::Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, what);
  h5::check(H5Pset_local_heap_size_hint(properties.get(), long_group_bytes), what);
  return h5::Handle(H5Gcreate2(id(), name, H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Gclose, what);
}

/// Behind the open file; HDF5 keeps owning it.
int KillSafeFile::descriptor() const {
  void* pointer = nullptr;
  h5::check(H5Fget_vfd_handle(id(), H5P_DEFAULT, &pointer), "cannot reach the file");
  return *static_cast<int*>(pointer);
}

void KillSafeFile::store(std::size_t bytes, const std::function<void()>& work) {
  if (broken_) throw std::runtime_error("an earlier write failed");
  reserve_space(descriptor(), bytes);
  try {
    work();
    flush();
  } catch (...) {
    broken_ = true;
    turn_into_memory(descriptor());
    throw;
  }
  release_reserved(descriptor());
}

void KillSafeFile::flush() const { h5::check(H5Fflush(id(), H5F_SCOPE_LOCAL), "cannot flush"); }

void KillSafeFile::to_disk() const {
  if (fsync(descriptor()) != 0) throw std::runtime_error("cannot write the results to the disk");
}

void KillSafeFile::close() { h5::check(H5Fclose(file_.release()), "cannot close"); }

}  // namespace quicksand
