#pragma once
// Frames and series out of a result file, finished or still being written.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/results/h5.hpp"

namespace quicksand {

/// A dataset of a frame, as it is sent: little-endian, point-major.
struct FrameArray {
  std::string name;
  std::string type;  ///< "float32", "uint8" or "int32"
  std::size_t components = 1;
  std::size_t item_bytes = 4;  ///< per component
};

struct FrameShape {
  double time = 0;  ///< s
  std::string stage;
  std::size_t points = 0;
  std::vector<FrameArray> arrays;
};

struct SeriesShape {
  std::string name, unit;
  std::size_t components = 1;
};

/// Sees what was flushed when it was opened. Not thread-safe. Members throw h5::Error when the file cannot
/// be read, which while it is being written may pass at the next try.
class ResultReader {
 public:
  /// Empty when the run has written nothing yet.
  static std::optional<ResultReader> open(const std::filesystem::path& run_folder);

  std::size_t frames() const { return frames_; }
  FrameShape frame(std::size_t index) const;
  /// Every `stride`-th point of one array, from the first one on.
  std::string array(std::size_t index, const FrameArray& array, std::size_t points, std::size_t stride) const;

  std::vector<SeriesShape> series() const;
  std::size_t samples(const std::string& series) const;
  /// Of the first `samples` samples: times, or values with their components side by side.
  std::vector<double> times(const std::string& series, std::size_t samples) const;
  std::vector<double> values(const SeriesShape& series, std::size_t samples) const;

 private:
  explicit ResultReader(const std::filesystem::path& file);

  h5::Handle file_;
  std::size_t frames_ = 0;
};

}  // namespace quicksand
