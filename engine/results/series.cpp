#include "engine/results/series.hpp"

#include <algorithm>
#include <stdexcept>

namespace quicksand {
namespace {

// Samples per chunk, 1 kB for a scalar: little is wasted on a short run, and 8192 samples need one leaf of
// the chunk index.
constexpr hsize_t samples_per_chunk = 128;

std::size_t width_of(const h5::Table& table) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(table.columns()));
}

}  // namespace

SeriesTables::SeriesTables(hid_t file, const std::vector<SeriesInfo>& series)
    : root_(h5::create_group(file, "series")) {
  for (const SeriesInfo& info : series) {
    if (info.name.find('/') != info.name.npos) throw std::logic_error("series name with '/': " + info.name);
    const h5::Handle group = h5::create_group(root_.get(), info.name);
    if (values_.empty()) {
      time_ = h5::Table(group.get(), "time", H5T_IEEE_F64LE, 0, samples_per_chunk, h5::Storage::in_place);
      h5::put_attribute(time_.id(), "unit", std::string("s"));
    } else if (!h5::exists(group.get(), "time")) {
      h5::check(H5Olink(time_.id(), group.get(), "time", H5P_DEFAULT, H5P_DEFAULT), "cannot link time");
    }
    const hsize_t columns = info.components == 1 ? 0 : static_cast<hsize_t>(info.components);
    values_.emplace_back(group.get(), "value", H5T_IEEE_F64LE, columns, samples_per_chunk,
                         h5::Storage::in_place);
    h5::put_attribute(values_.back().id(), "unit", info.unit);
    width_ += static_cast<std::size_t>(info.components);
  }
}

void SeriesTables::go_back(std::size_t samples) {
  if (values_.empty()) return;
  time_.go_back(samples);
  for (h5::Table& table : values_) table.go_back(samples);
}

void SeriesTables::trim() {
  if (values_.empty()) return;
  time_.trim();
  for (h5::Table& table : values_) table.trim();
}

void SeriesTables::sample(double time, const std::vector<double>& values) {
  if (values.size() != width_) throw std::logic_error("sample of other length than the series");
  times_.push_back(time);
  kept_.insert(kept_.end(), values.begin(), values.end());
}

void SeriesTables::store() {
  if (times_.empty() || values_.empty()) return;
  const std::size_t samples = times_.size();
  std::size_t first = 0;  // of this series' components within a sample
  std::vector<double> column;
  for (h5::Table& table : values_) {
    const std::size_t width = width_of(table);
    column.clear();
    for (std::size_t i = 0; i < samples; ++i) {
      const auto from = kept_.begin() + static_cast<std::ptrdiff_t>(i * width_ + first);
      column.insert(column.end(), from, from + static_cast<std::ptrdiff_t>(width));
    }
    table.append(samples, H5T_NATIVE_DOUBLE, column.data());
    first += width;
  }
  time_.append(samples, H5T_NATIVE_DOUBLE, times_.data());
  times_.clear();
  kept_.clear();
}

}  // namespace quicksand
