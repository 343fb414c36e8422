#pragma once
// Water that swings: its centre of mass over time, periods and energies.

#include <cmath>

#include "tests/verification/book.hpp"

namespace quicksand::test {

/// Mean x of all points (of equal mass) of each frame, m.
inline std::vector<double> centers(const Recorded& r) {
  std::vector<double> x;
  for (const Frame& frame : r.results.frames) {
    double sum = 0;
    for (std::size_t p = 0; p < frame.points(); ++p) sum += frame.position[3 * p];
    x.push_back(sum / static_cast<double>(frame.points()));
  }
  return x;
}

inline std::vector<double> frame_times(const Recorded& r) {
  std::vector<double> t;
  for (const Frame& frame : r.results.frames) t.push_back(frame.time);
  return t;
}

/// Times at which y passes `level`, linear between samples.
inline std::vector<double> crossings(const std::vector<double>& t, const std::vector<double>& y,
                                     double level) {
  std::vector<double> times;
  for (std::size_t i = 1; i < y.size(); ++i)
    if ((y[i - 1] - level) * (y[i] - level) < 0)
      times.push_back(t[i - 1] + (t[i] - t[i - 1]) * (level - y[i - 1]) / (y[i] - y[i - 1]));
  return times;
}

/// Twice the mean time between crossings, s.
inline double period(const std::vector<double>& crossing) {
  return 2 * (crossing.back() - crossing.front()) / static_cast<double>(crossing.size() - 1);
}

/// Largest rise of the energy above any earlier value, J.
inline double largest_rise(const std::vector<double>& energy) {
  double least = energy.front(), rise = 0;
  for (const double e : energy) {
    rise = std::max(rise, e - least);
    least = std::min(least, e);
  }
  return rise;
}

}  // namespace quicksand::test
