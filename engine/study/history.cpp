#include "engine/study/history.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace quicksand {
namespace {

bool was_asked_for(std::string_view name) {
  for (const std::string_view kind : {"probe.", "section.", "reservoir.", "plate.", "body."})
    if (name.starts_with(kind)) return true;
  return false;
}

}  // namespace

double Curve::at(double t) const {
  const auto next = std::lower_bound(time.begin(), time.end(), t);
  if (next == time.begin()) return value.front();
  if (next == time.end()) return value.back();
  const std::size_t k = static_cast<std::size_t>(next - time.begin());
  const double part = (t - time[k - 1]) / (time[k] - time[k - 1]);
  return value[k - 1] + part * (value[k] - value[k - 1]);
}

double Curve::range() const {
  double low = 0, high = 0;
  for (const double v : value) low = std::min(low, v), high = std::max(high, v);
  return high - low;
}

double distance(const Curve& a, const Curve& b) {
  if (a.time.empty() || b.time.empty()) return 0;
  const double first = std::max(a.time.front(), b.time.front()),
               last = std::min(a.time.back(), b.time.back());
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t k = 0; k < a.time.size(); ++k) {
    if (a.time[k] < first || a.time[k] > last) continue;
    const double d = a.value[k] - b.at(a.time[k]);
    sum += d * d, ++n;
  }
  return n ? std::sqrt(sum / static_cast<double>(n)) : 0;
}

void HistorySink::begin(const std::vector<SeriesInfo>& series) {
  info_ = series;
  if (next_) next_->begin(series);
}

void HistorySink::frame(Frame frame) {
  if (next_) next_->frame(std::move(frame));
}

void HistorySink::sample(double time, const std::vector<double>& values) {
  time_.push_back(time);
  rows_.push_back(values);
  if (next_) next_->sample(time, values);
}

void HistorySink::checkpoint(const Checkpoint& checkpoint) {
  if (next_) next_->checkpoint(checkpoint);
}

std::vector<Curve> HistorySink::curves(int dimensions) const {
  std::vector<Curve> all;
  std::size_t column = 0;
  for (const SeriesInfo& series : info_) {
    const int shown = series.components == 3 ? dimensions : series.components;
    if (was_asked_for(series.name))
      for (int c = 0; c < shown; ++c) {
        Curve curve{series.name, series.unit, c, time_, {}};
        for (const auto& row : rows_) curve.value.push_back(row[column + static_cast<std::size_t>(c)]);
        all.push_back(std::move(curve));
      }
    column += static_cast<std::size_t>(series.components);
  }
  return all;
}

}  // namespace quicksand
