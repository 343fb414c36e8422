#pragma once
// Principal values of several symmetric tensors at once.

#include "engine/materials/tensor.hpp"

namespace quicksand {

/// In any order, with the directions that they go with.
template <int D>
class PrincipalLanes;

/// In the plane: the larger and the smaller one in it, and z.
template <>
class PrincipalLanes<2> {
 public:
  std::array<BatchLanes, 3> value;

  QUICKSAND_INLINE explicit PrincipalLanes(const Stress<2, BatchLanes>& s) {
    const BatchLanes mean = 0.5 * (s[0] + s[1]), half = 0.5 * (s[0] - s[1]);
    const BatchLanes radius = square_root(half * half + s[3] * s[3]), one = all_lanes<BatchLanes>(1);
    const auto round = radius > 0;
    const BatchLanes inverse = 1.0 / where(round, radius, one);
    cos2_ = where(round, half * inverse, one);
    sin2_ = s[3] * inverse;
    value = {mean + radius, mean - radius, s[2]};
  }
  /// The tensors with other values in the same directions.
  QUICKSAND_INLINE Stress<2, BatchLanes> with(const std::array<BatchLanes, 3>& v) const {
    const BatchLanes mean = 0.5 * (v[0] + v[1]), radius = 0.5 * (v[0] - v[1]);
    return {mean + radius * cos2_, mean - radius * cos2_, v[2], radius * sin2_};
  }

 private:
  BatchLanes cos2_, sin2_;
};

/// By Jacobi's rotations, always the same number of them, so that lanes need not ask: off the diagonal the
/// fourth sweep leaves nothing that counts (G. H. Golub, C. F. Van Loan, Matrix Computations, § 8.5).
template <>
class PrincipalLanes<3> {
 public:
  std::array<BatchLanes, 3> value;

  QUICKSAND_INLINE explicit PrincipalLanes(const Stress<3, BatchLanes>& s) {
    const BatchLanes zero{}, one = all_lanes<BatchLanes>(1);
    BatchLanes size{};
    for (const BatchLanes& entry : s) {
      const BatchLanes absolute = where(entry < zero, -entry, entry);
      size = where(absolute > size, absolute, size);
    }
    size = where(size > zero, size, one);
    const BatchLanes inverse = 1.0 / size;  // so that no square comes to nothing
    for (int i = 0; i < 3; ++i) value[i] = s[i] * inverse;
    axis_ = {{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}};
    // Opposite the axis that it does not hold: yz, zx, xy.
    std::array<BatchLanes, 3> off{s[4] * inverse, s[5] * inverse, s[3] * inverse};
    for (int sweep = 0; sweep < 4; ++sweep)
      for (int r = 2; r >= 0; --r) rotate((r + 1) % 3, (r + 2) % 3, r, off);
    for (BatchLanes& v : value) v *= size;
  }
  QUICKSAND_INLINE Stress<3, BatchLanes> with(const std::array<BatchLanes, 3>& v) const {
    const auto entry = [&](int a, int b) __attribute__((always_inline)) {
      BatchLanes sum{};
      for (int i = 0; i < 3; ++i) sum += v[i] * axis_[i][a] * axis_[i][b];
      return sum;
    };
    return {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(2, 0)};
  }

 private:
  /// Makes the entry of axes p and q, off[r], zero.
  QUICKSAND_INLINE void rotate(int p, int q, int r, std::array<BatchLanes, 3>& off) {
    // The angle's double has the cosine |half|/radius and the sine entry/radius.
    const BatchLanes entry = off[r], half = 0.5 * (value[q] - value[p]), zero{}, one = zero + 1.0;
    const BatchLanes square = half * half + entry * entry;
    const auto none = square < kNothing;
    const BatchLanes inverse = inverse_root(where(none, one, square));
    const BatchLanes c2 = 0.5 + 0.5 * where(half < zero, -half, half) * inverse;
    const BatchLanes inverse_c = inverse_root(where(none, one, c2));
    const BatchLanes c = where(none, one, c2 * inverse_c);
    const BatchLanes s = where(none, zero, 0.5 * where(half < zero, -entry, entry) * inverse * inverse_c);
    const BatchLanes t = s * inverse_c;
    value[p] -= t * entry;
    value[q] += t * entry;
    off[r] = zero;
    const BatchLanes rp = off[q], rq = off[p];  // entries (r, p) and (r, q)
    off[q] = c * rp - s * rq;
    off[p] = s * rp + c * rq;
    for (int i = 0; i < 3; ++i) {
      const BatchLanes vp = axis_[p][i], vq = axis_[q][i];
      axis_[p][i] = c * vp - s * vq;
      axis_[q][i] = s * vp + c * vq;
    }
  }
  /// Of a sum of squares, where the largest entry is one.
  static constexpr double kNothing = 1e-60;
  std::array<std::array<BatchLanes, 3>, 3> axis_;  ///< [value][component]
};

}  // namespace quicksand
