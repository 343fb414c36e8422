#include "engine/results/result_file.hpp"

#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>

#include "engine/results/kill_safe_file.hpp"
#include "engine/results/result_names.hpp"
#include "engine/results/result_reader.hpp"
#include "engine/results/series.hpp"
#include "engine/results/vtkhdf.hpp"
#include "engine/results/xdmf.hpp"
#include "engine/run/archive.hpp"

namespace quicksand {
namespace {

namespace fs = std::filesystem;

// Room for what HDF5 writes besides the points of a frame: chunk indices that split, views, names (some 20 kB
// as a rule), and besides the text of a document.
constexpr std::size_t frame_bookkeeping_bytes = 512 * 1024, bookkeeping_bytes = 32 * 1024;
// Room for a growing series that starts a chunk, per series.
constexpr std::size_t chunk_of_series_bytes = 16 * 1024;
// Samples kept in memory between frames before they are stored.
constexpr std::size_t most_kept_samples = 4096;

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
  for (const char* name : {"engine_version", "engine_build", "case_resolved"})
    if (const auto document = documents.find(name); document != documents.end())
      identity += document->second + "\n";
  return identity;
}

void remove_result_files(const std::string& folder) {
  remove_named_results(folder);
  remove_checkpoints(folder);
}

bool finish_result_files(const std::string& folder) {
  std::error_code none;
  if (!fs::exists(unfinished(folder, data_name), none) || !fs::exists(unfinished(folder, view_name), none))
    return false;
  try {
    h5::silence();
    const auto file = ResultReader::open(folder);
    if (!file) return false;
    for (std::size_t i = 0; i < file->frames(); ++i) file->frame(i);
    finish_names(folder);
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

struct ResultFile::State {
  fs::path folder;
  std::string identity;
  KillSafeFile file;
  h5::Handle run, frames;
  std::optional<Vtkhdf> vtkhdf;
  std::optional<SeriesTables> series;
  std::optional<Xdmf> xdmf;
  std::optional<std::size_t> samples;  // that a file which was opened keeps

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
    file = KillSafeFile::create(unfinished(folder, data_name).string());
    std::size_t bytes = 0;
    for (const auto& [name, text] : documents) bytes += text.size() + bookkeeping_bytes;
    store(bytes, [&] {
      run = h5::create_group(file.id(), "run");
      for (const auto& [name, text] : documents) h5::put_text(run.get(), name, text);
      frames = file.create_long_group("frames");
      vtkhdf.emplace(file.id());
    });
    // The view names the finished file: whoever rescues a killed run drops ".part" from both names.
    xdmf.emplace(unfinished(folder, view_name).string(), data_name);
  }

  /// Opens what an interrupted run left. What came after the checkpoint is not cut off, as a kill between two
  /// writes of a file that becomes shorter would spoil it: the run writes the same over it, bit for bit.
  void reopen(const StoredCheckpoint& from) {
    unfinish_names(folder);
    Loader results(from.results);
    Vtkhdf::Extent extent;
    results(extent);
    file = KillSafeFile::open(unfinished(folder, data_name).string());
    run = h5::create_group(file.id(), "run");
    frames = h5::create_group(file.id(), "frames");
    vtkhdf.emplace(file.id());
    vtkhdf->go_back(extent);
    for (std::size_t i = from.run.frames; h5::exists(frames.get(), frame_name(i)); ++i)
      h5::require_whole(h5::create_group(frames.get(), frame_name(i)).get());
    samples = from.run.samples;
    xdmf.emplace(unfinished(folder, view_name).string(), data_name, from.run.frames);
  }

  /// With the samples that wait. See KillSafeFile::store.
  void store(std::size_t bytes, const std::function<void()>& work) {
    if (series && series->kept() > 0)
      bytes += series->kept() * series->sample_bytes() + series->count() * chunk_of_series_bytes;
    file.store(bytes, work);
  }

  /// The frame is whole on disk before it has a name, and has one before it is counted (ordered_driver.cpp).
  void put_frame(const Frame& frame) {
    const std::string name = frame_name(frame.index);
    if (series) series->store();
    const Vtkhdf::Rows rows = vtkhdf->append(frame);
    const bool named = h5::exists(frames.get(), name);
    const h5::Handle group =
        named ? h5::create_group(frames.get(), name) : h5::create_unnamed_group(frames.get());
    h5::put_attribute(group.get(), "time", frame.time);
    h5::put_attribute(group.get(), "stage", frame.stage);
    vtkhdf->put_views(group.get(), rows);
    file.flush();
    if (!named) h5::give_name(group.get(), frames.get(), name);
    vtkhdf->count_frame();
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
    file.close();
    xdmf.reset();
    finish_names(folder);
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
      state_->series.emplace(state_->file.id(), series);
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
    state_->file.to_disk();
    state_->xdmf->to_disk();
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
