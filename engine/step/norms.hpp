#pragma once
// Norms and products of long vectors, several numbers at a time; the same bits for any number of threads.

#include <cmath>
#include <vector>

#include "engine/grid/lanes.hpp"
#include "engine/threads/chunks.hpp"

namespace quicksand {

/// Largest magnitude of many numbers, several at a time; not a number if one is.
class Largest {
 public:
  QUICKSAND_INLINE void add(const BatchLanes& v) {
    const BatchLanes size = where(v < 0, -v, v);
    most_ = where(size > most_, size, most_);
    sick_ += v - v;  // 0, or not a number
  }
  double of(double v) const {
    double most = std::abs(v);
    for (int k = 0; k < kBatch; ++k) most = larger(most, sick_[k] == 0 ? most_[k] : sick_[k]);
    return most;
  }
  static double larger(double a, double b) { return b > a || std::isnan(b) ? b : a; }

 private:
  BatchLanes most_{}, sick_{};
};

/// f(i) → kBatch numbers from i on, one(i) → number i.
template <class F, class One>
double largest(std::size_t n, F&& f, One&& one) {
  return reduce_chunks(
      n, 0.0,
      [&](std::size_t begin, std::size_t end) {
        Largest most;
        double rest = 0;
        std::size_t i = begin;
        for (; i + kBatch <= end; i += kBatch) most.add(f(i));
        for (; i < end; ++i) rest = Largest::larger(rest, std::abs(one(i)));
        return most.of(rest);
      },
      Largest::larger);
}

/// Σ a[i] b[i], i < n.
inline double lanes_dot(std::size_t n, const double* a, const double* b) {
  BatchLanes sums{};
  double sum = 0;
  std::size_t i = 0;
  for (; i + kBatch <= n; i += kBatch) sums += lanes_from<kBatch>(a[i]) * lanes_from<kBatch>(b[i]);
  for (; i < n; ++i) sum += a[i] * b[i];
  for (int k = 0; k < kBatch; ++k) sum += sums[k];
  return sum;
}
inline double dot(std::size_t n, const std::vector<double>& a, const std::vector<double>& b) {
  const auto part = [&](std::size_t begin, std::size_t end) {
    return lanes_dot(end - begin, a.data() + begin, b.data() + begin);
  };
  return reduce_chunks(n, 0.0, part, [](double x, double y) { return x + y; });
}

}  // namespace quicksand
