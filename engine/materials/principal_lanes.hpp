#pragma once
// Principal values of several symmetric tensors at once.

#include "engine/materials/tensor.hpp"

namespace quicksand {

/// Descending, and what makes tensors of them again.
template <int D>
class PrincipalLanes;

/// The largest of three, the middle and the smallest one.
QUICKSAND_INLINE std::array<BatchLanes, 3> descending(const BatchLanes& a, const BatchLanes& b,
                                                      const BatchLanes& c) {
  const BatchLanes low = where(a < b, a, b), high = where(a < b, b, a);
  return {where(c > high, c, high), clamped<BatchLanes>(c, low, high), where(c < low, c, low)};
}

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
    larger_ = mean + radius, smaller_ = mean - radius, z_ = s[2];
    value = descending(larger_, smaller_, z_);
  }
  /// The tensors with other values in the same directions, descending too.
  QUICKSAND_INLINE Stress<2, BatchLanes> with(const std::array<BatchLanes, 3>& v) const {
    const auto instead_of = [&](const BatchLanes& old) __attribute__((always_inline)) {
      // Where two values are one, so are those that they become.
      return where(old >= value[0], v[0], where(old <= value[2], v[2], v[1]));
    };
    const BatchLanes larger = instead_of(larger_), smaller = instead_of(smaller_);
    const BatchLanes mean = 0.5 * (larger + smaller), radius = 0.5 * (larger - smaller);
    return {mean + radius * cos2_, mean - radius * cos2_, instead_of(z_), radius * sin2_};
  }

 private:
  BatchLanes cos2_, sin2_;           ///< of twice the angle of the larger one in the plane from x
  BatchLanes larger_, smaller_, z_;  ///< in the plane, and across it
};

/// By Jacobi's rotations, until no lane has anything off the diagonal that counts, which is after the fourth
/// sweep at the latest (G. H. Golub, C. F. Van Loan, Matrix Computations, § 8.5).
template <>
class PrincipalLanes<3> {
 public:
  std::array<BatchLanes, 3> value;

  QUICKSAND_INLINE explicit PrincipalLanes(const Stress<3, BatchLanes>& s) {
    const BatchLanes zero{}, one = all_lanes<BatchLanes>(1);
    size_ = zero;
    for (const BatchLanes& entry : s) {
      const BatchLanes absolute = where(entry < zero, -entry, entry);
      size_ = where(absolute > size_, absolute, size_);
    }
    size_ = where(size_ > zero, size_, one);
    const BatchLanes inverse = 1.0 / size_;  // so that no square comes to nothing
    for (int i = 0; i < 6; ++i) scaled_[i] = s[i] * inverse;
    std::array<BatchLanes, 3> diagonal{scaled_[0], scaled_[1], scaled_[2]};
    // Opposite the axis that it does not hold: yz, zx, xy.
    std::array<BatchLanes, 3> off{scaled_[4], scaled_[5], scaled_[3]};
    for (int sweep = 0; sweep < 4; ++sweep) {
      const BatchLanes left = off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
      if (!any_of(left > kNothing, kBatch)) break;
      for (int r = 2; r >= 0; --r) rotate((r + 1) % 3, (r + 2) % 3, r, diagonal, off);
    }
    own_ = descending(diagonal[0], diagonal[1], diagonal[2]);
    for (int i = 0; i < 3; ++i) value[i] = own_[i] * size_;
  }
  /// The tensors with other values v in the same directions, descending too and no further apart than a few
  /// times `value`, without the directions: the polynomial of σ that takes its values σi to vi, by Newton's
  /// divided differences. What is lost in the difference of two close values goes with their distance.
  QUICKSAND_INLINE Stress<3, BatchLanes> with(const std::array<BatchLanes, 3>& v) const {
    const auto& [s1, s2, s3] = own_;
    const BatchLanes inverse = 1.0 / size_;
    const BatchLanes v12 = slope((v[0] - v[1]) * inverse, s1 - s2),
                     v23 = slope((v[1] - v[2]) * inverse, s2 - s3), v123 = slope(v12 - v23, s1 - s3);
    const auto& [xx, yy, zz, xy, yz, zx] = scaled_;
    const BatchLanes xx1 = xx - s1, yy1 = yy - s1, zz1 = zz - s1;  // σ − σ1 I, and σ − σ2 I
    const BatchLanes xx2 = xx - s2, yy2 = yy - s2, zz2 = zz - s2;
    return {v[0] + size_ * (v12 * xx1 + v123 * (xx1 * xx2 + xy * xy + zx * zx)),
            v[0] + size_ * (v12 * yy1 + v123 * (xy * xy + yy1 * yy2 + yz * yz)),
            v[0] + size_ * (v12 * zz1 + v123 * (zx * zx + yz * yz + zz1 * zz2)),
            size_ * (v12 * xy + v123 * (xx1 * xy + xy * yy2 + zx * yz)),
            size_ * (v12 * yz + v123 * (xy * zx + yy1 * yz + yz * zz2)),
            size_ * (v12 * zx + v123 * (xx1 * zx + xy * yz + zx * zz2))};
  }

 private:
  /// 0 where values are one.
  QUICKSAND_INLINE static BatchLanes slope(const BatchLanes& rise, const BatchLanes& run) {
    const auto apart = run > kSame;
    return where(apart, rise / where(apart, run, all_lanes<BatchLanes>(1)), BatchLanes{});
  }
  /// Makes the entry of axes p and q, off[r], zero.
  QUICKSAND_INLINE static void rotate(int p, int q, int r, std::array<BatchLanes, 3>& diagonal,
                                      std::array<BatchLanes, 3>& off) {
    // The angle's double has the cosine |half|/radius and the sine entry/radius.
    const BatchLanes entry = off[r], half = 0.5 * (diagonal[q] - diagonal[p]), zero{}, one = zero + 1.0;
    const BatchLanes square = half * half + entry * entry;
    const auto none = square < kNothing;
    const BatchLanes inverse = inverse_root(where(none, one, square));
    const BatchLanes c2 = 0.5 + 0.5 * where(half < zero, -half, half) * inverse;
    const BatchLanes inverse_c = inverse_root(where(none, one, c2));
    const BatchLanes c = where(none, one, c2 * inverse_c);
    const BatchLanes s = where(none, zero, 0.5 * where(half < zero, -entry, entry) * inverse * inverse_c);
    const BatchLanes t = s * inverse_c;
    diagonal[p] -= t * entry;
    diagonal[q] += t * entry;
    off[r] = zero;
    const BatchLanes rp = off[q], rq = off[p];  // entries (r, p) and (r, q)
    off[q] = c * rp - s * rq;
    off[p] = s * rp + c * rq;
  }
  /// Where the largest entry is one: of a sum of squares, and of the distance of two values.
  static constexpr double kNothing = 1e-36, kSame = 1e-14;
  BatchLanes size_;                ///< the largest entry
  Stress<3, BatchLanes> scaled_;   ///< by it
  std::array<BatchLanes, 3> own_;  ///< values of `scaled_`
};

}  // namespace quicksand
