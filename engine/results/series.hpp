#pragma once
#include <vector>

#include "engine/results/h5.hpp"
#include "engine/run/run.hpp"

namespace quicksand {

/// The group `/series`: one group per history with `time` and `value` (attribute `unit`). All histories are
/// sampled together, so their `time` is one dataset under many names.
class SeriesTables {
 public:
  /// Opens what is there. A name with '/' is a std::logic_error.
  SeriesTables(hid_t file, const std::vector<SeriesInfo>& series);

  /// Keeps one sample in memory; `values` holds every series' components one after the other.
  void sample(double time, const std::vector<double>& values);
  /// Appends the kept samples to the file.
  void store();
  /// Of groups that were opened: samples after the first ones are written over; and removes what was not.
  void go_back(std::size_t samples);
  void trim();
  std::size_t count() const { return values_.size(); }
  std::size_t kept() const { return times_.size(); }
  /// Bytes that one sample takes in the file.
  std::size_t sample_bytes() const { return sizeof(double) * (1 + width_); }

 private:
  h5::Handle root_;
  h5::Table time_;
  std::vector<h5::Table> values_;  // as `series`
  std::size_t width_ = 0;          // numbers per sample
  std::vector<double> times_, kept_;
};

}  // namespace quicksand
