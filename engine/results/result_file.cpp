#include "engine/results/result_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <tuple>

#include "engine/results/disk_space.hpp"
#include "engine/results/h5.hpp"
#include "engine/results/series.hpp"
#include "engine/results/vtkhdf.hpp"
#include "engine/results/xdmf.hpp"
#include "engine/run/archive.hpp"

namespace quicksand {
namespace {

namespace fs = std::filesystem;

constexpr const char* data_name = "result.vtkhdf";
constexpr const char* view_name = "result.xdmf";
constexpr const char* unfinished = ".part";

// Room for what HDF5 writes besides the points of a frame: chunk indices that split, views, names (some 20 kB
// as a rule), and besides the text of a document.
constexpr std::size_t frame_bookkeeping_bytes = 512 * 1024, bookkeeping_bytes = 32 * 1024;
// Room for a growing series that starts a chunk, per series.
constexpr std::size_t chunk_of_series_bytes = 16 * 1024;
// Samples kept in memory between frames before they are stored.
constexpr std::size_t most_kept_samples = 4096;
// Metadata kept in memory, so that between two flushes none of it is written: a kill then finds the file as
// the last flush left it. A frame dirties some 100 kB.
constexpr std::size_t metadata_cache_bytes = 16 * 1024 * 1024;
// Half the entries of a symbol-table leaf (40 bytes each) and of a tree node: a frame's arrays fit one leaf,
// and /frames seldom splits one, which is the moment when a kill could cost names of older frames.
constexpr unsigned group_leaf_k = 16, group_tree_k = 16;
// Room for the names in /frames (8 bytes each), so that their heap does not move as it grows.
constexpr std::size_t frame_names_bytes = 16 * 1024;

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
  cache.max_size = std::max(cache.max_size, metadata_cache_bytes);
  cache.decr_mode = H5C_decr__off;
  h5::check(H5Pset_mdc_config(access.get(), &cache), what);
  return access;
}

h5::Handle open_file(const std::string& path) {
  const std::string what = "cannot open the file";
  return h5::Handle(H5Fopen(path.c_str(), H5F_ACC_RDWR, file_access(what).get()), H5Fclose, what);
}

h5::Handle create_file(const std::string& path) {
  const std::string what = "cannot create the file";
  const h5::Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, what);
  h5::check(H5Pset_sym_k(creation.get(), group_tree_k, group_leaf_k), what);
  h5::check(H5Pset_obj_track_times(creation.get(), false), what);
  const h5::Handle access = file_access(what);
  return h5::Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose, what);
}

h5::Handle create_frames_group(hid_t file) {
  const std::string what = "cannot create group frames";
  const h5::Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, what);
  h5::check(H5Pset_local_heap_size_hint(properties.get(), frame_names_bytes), what);
  return h5::Handle(H5Gcreate2(file, "frames", H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Gclose, what);
}

/// The descriptor behind an open HDF5 file; HDF5 keeps owning it.
int descriptor(const h5::Handle& file) {
  void* pointer = nullptr;
  h5::check(H5Fget_vfd_handle(file.get(), H5P_DEFAULT, &pointer), "cannot reach the file");
  return *static_cast<int*>(pointer);
}

/// Tells the file's heading where the file will end, before a flush writes what lies behind the old end: HDF5
/// itself does so last, and a kill between the two leaves names that point beyond the end.
void announce_end(const h5::Handle& file) {
  haddr_t end = 0;
  h5::check(H5Fget_eoa(file.get(), &end), "cannot find the file's end");
  const int number = descriptor(file);
  unsigned char version = 0xff;
  constexpr off_t version_at = 8;
  if (pread(number, &version, 1, version_at) != 1 || version > 1) return;
  const off_t end_at = version == 0 ? 40 : 44;  // HDF5 file format, superblock versions 0 and 1
  struct stat status {};
  if (fstat(number, &status) != 0) return;
  const std::uint64_t stored = end;  // little-endian, as the machine
  if (status.st_size < static_cast<off_t>(end) && ftruncate(number, static_cast<off_t>(end)) != 0) return;
  std::ignore = pwrite(number, &stored, sizeof stored, end_at);
}

std::string frame_name(std::size_t index) {
  char name[24];
  std::snprintf(name, sizeof name, "%06zu", index);
  return name;
}

/// Bytes of a frame before compression.
std::size_t frame_bytes(const Frame& frame) {
  std::size_t bytes = frame.points() * (3 * sizeof(double) + sizeof(std::uint8_t) + sizeof(std::int32_t) +
                                        2 * sizeof(long long));
  for (const FrameField& field : frame.fields) bytes += field.values.size() * sizeof(float);
  return bytes;
}

void finish_name(const fs::path& folder, const char* name) {
  std::error_code error;
  fs::rename(folder / (std::string(name) + unfinished), folder / name, error);
  if (error) throw std::runtime_error(std::string("cannot rename ") + name + ": " + error.message());
}

/// Undoes that, where it was done.
void unfinish_name(const fs::path& folder, const std::string& name) {
  std::error_code none;
  if (!fs::exists(folder / (name + unfinished), none))
    fs::rename(folder / name, folder / (name + unfinished), none);
}

/// Runs `work`; what it throws about the disk leaves with the file's name in front.
template <class Work>
void naming_the_file(Work&& work) {
  try {
    h5::silence();
    work();
  } catch (const std::logic_error&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string(data_name) + ": " + error.what());
  }
}

}  // namespace

std::string run_identity(const std::map<std::string, std::string>& documents) {
  std::string identity;
  for (const char* name : {"engine_version", "case_resolved"})
    if (const auto document = documents.find(name); document != documents.end())
      identity += document->second + "\n";
  return identity;
}

void remove_result_files(const std::string& folder) {
  for (const char* name : {data_name, view_name})
    for (const char* ending : {"", unfinished}) fs::remove(fs::path(folder) / (std::string(name) + ending));
  remove_checkpoints(folder);
}

struct ResultFile::State {
  fs::path folder;
  std::string identity;
  h5::Handle file, run, frames;
  std::optional<Vtkhdf> vtkhdf;
  std::optional<SeriesTables> series;
  std::optional<Xdmf> xdmf;
  std::optional<std::size_t> samples;  // that a file which was opened keeps
  bool broken = false;                 // a write failed halfway: nothing more may follow it

  State(const std::string& to, const std::map<std::string, std::string>& documents,
        const StoredCheckpoint* resume)
      : folder(to), identity(run_identity(documents)) {
    if (resume)
      reopen(*resume);
    else
      create(documents);
  }

  void create(const std::map<std::string, std::string>& documents) {
    remove_checkpoints(folder);
    file = create_file((folder / (std::string(data_name) + unfinished)).string());
    std::size_t bytes = 0;
    for (const auto& [name, text] : documents) bytes += text.size() + bookkeeping_bytes;
    store(bytes, [&] {
      run = h5::create_group(file.get(), "run");
      for (const auto& [name, text] : documents) h5::put_text(run.get(), name, text);
      frames = create_frames_group(file.get());
      vtkhdf.emplace(file.get());
    });
    // The view names the finished file: whoever rescues a killed run drops ".part" from both names.
    xdmf.emplace((folder / (std::string(view_name) + unfinished)).string(), data_name);
  }

  /// Opens what an interrupted run left. What came after the checkpoint is not cut off, as a kill between two
  /// writes of a file that becomes shorter would spoil it: the run writes the same over it, bit for bit.
  void reopen(const StoredCheckpoint& from) {
    for (const char* name : {data_name, view_name}) unfinish_name(folder, name);
    Loader results(from.results);
    Vtkhdf::Extent extent;
    results(extent);
    file = open_file((folder / (std::string(data_name) + unfinished)).string());
    // A kill within a flush can leave objects behind the end that the file knows of.
    h5::check(H5Fincrement_filesize(file.get(), 0), "cannot go on with the file");
    run = h5::create_group(file.get(), "run");
    frames = h5::create_group(file.get(), "frames");
    vtkhdf.emplace(file.get());
    vtkhdf->go_back(extent);
    for (std::size_t i = from.run.frames; h5::exists(frames.get(), frame_name(i)); ++i)
      h5::require_whole(h5::create_group(frames.get(), frame_name(i)).get());
    samples = from.run.samples;
    xdmf.emplace((folder / (std::string(view_name) + unfinished)).string(), data_name, from.run.frames);
  }

  void to_disk() const {
    if (fsync(descriptor(file)) != 0) throw std::runtime_error("cannot write the results to the disk");
    xdmf->to_disk();
  }

  void flush() {
    announce_end(file);
    h5::check(H5Fflush(file.get(), H5F_SCOPE_LOCAL), "cannot flush");
  }

  /// Makes room, then writes and flushes. Without room nothing has changed and the file can go on.
  template <class Work>
  void store(std::size_t bytes, Work&& work) {
    if (broken) throw std::runtime_error("an earlier write failed");
    std::size_t samples = 0;
    if (series && series->kept() > 0)
      samples = series->kept() * series->sample_bytes() + series->count() * chunk_of_series_bytes;
    reserve_space(descriptor(file), bytes + samples);
    try {
      work();
      flush();
    } catch (...) {
      broken = true;
      turn_into_memory(descriptor(file));
      throw;
    }
    release_reserved(descriptor(file));
  }

  void put_frame(const Frame& frame) {
    const std::string name = frame_name(frame.index);
    if (series) series->store();
    const Vtkhdf::Rows rows = vtkhdf->append(frame);
    const h5::Handle group = h5::create_group(frames.get(), name);
    h5::put_attribute(group.get(), "time", frame.time);
    h5::put_attribute(group.get(), "stage", frame.stage);
    vtkhdf->put_views(group.get(), rows);
  }

  /// Frames and samples of an interrupted run that this one, ended sooner, has not reached.
  void trim() {
    if (series) series->trim();
    vtkhdf->trim();
    for (auto i = static_cast<std::size_t>(vtkhdf->extent().frames); h5::exists(frames.get(), frame_name(i));
         ++i)
      h5::check(H5Ldelete(frames.get(), frame_name(i).c_str(), H5P_DEFAULT), "cannot cut the frames");
  }

  void finish() {
    series.reset();
    vtkhdf.reset();
    frames.reset();
    run.reset();
    h5::check(H5Fclose(file.release()), "cannot close");
    xdmf.reset();
    finish_name(folder, data_name);
    finish_name(folder, view_name);
  }
};

ResultFile::ResultFile(const std::string& folder, const std::map<std::string, std::string>& documents,
                       const StoredCheckpoint* resume) {
  naming_the_file([&] { state_ = std::make_unique<State>(folder, documents, resume); });
}

ResultFile::~ResultFile() {
  h5::silence();
  state_.reset();
}

void ResultFile::begin(const std::vector<SeriesInfo>& series) {
  naming_the_file([&] {
    const std::size_t bytes = (series.size() + 1) * chunk_of_series_bytes;
    state_->store(bytes, [&] {
      state_->series.emplace(state_->file.get(), series);
      if (state_->samples) state_->series->go_back(*state_->samples);
    });
  });
}

void ResultFile::frame(Frame frame) {
  naming_the_file([&] {
    state_->store(frame_bytes(frame) + frame_bookkeeping_bytes, [&] { state_->put_frame(frame); });
    state_->xdmf->add(frame, "/frames/" + frame_name(frame.index));
  });
}

void ResultFile::sample(double time, const std::vector<double>& values) {
  naming_the_file([&] {
    if (!state_->series) throw std::logic_error("sample before begin");
    state_->series->sample(time, values);
    if (state_->series->kept() >= most_kept_samples)
      state_->store(bookkeeping_bytes, [&] { state_->series->store(); });
  });
}

void ResultFile::checkpoint(const Checkpoint& checkpoint) {
  naming_the_file([&] {
    state_->store(bookkeeping_bytes, [&] { state_->series->store(); });
    state_->to_disk();
  });
  Saver results;
  Vtkhdf::Extent extent = state_->vtkhdf->extent();
  results(extent);
  try {
    store_checkpoint(state_->folder, state_->identity, std::move(results.bytes), checkpoint);
  } catch (const std::runtime_error&) {  // the one before serves
  }
}

void ResultFile::document(const std::string& name, const std::string& text) {
  naming_the_file([&] {
    state_->store(text.size() + bookkeeping_bytes, [&] { h5::put_text(state_->run.get(), name, text); });
  });
}

void ResultFile::close() {
  naming_the_file([&] {
    state_->store(bookkeeping_bytes, [&] {
      if (state_->series) state_->series->store();
      if (state_->samples) state_->trim();
    });
    state_->finish();
    state_.reset();
  });
}

}  // namespace quicksand
