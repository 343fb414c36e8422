#pragma once
// Symmetric tensors as points hold them, xx yy zz xy [yz zx] with tensor (not engineering) shear components.

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "engine/grid/lanes.hpp"
#include "engine/points/points.hpp"

namespace quicksand {

// T is double, or lanes of several points (engine/grid/lanes.hpp).

/// Velocity gradient, ∂v_i/∂x_j in 1/s.
template <int D, class T = double>
using Gradient = std::array<std::array<T, D>, D>;
template <int D, class T = double>
using Strain = Stress<D, T>;

template <class T, std::size_t N>
QUICKSAND_INLINE T trace(const std::array<T, N>& t) {
  return t[0] + t[1] + t[2];
}

template <class T, std::size_t N>
QUICKSAND_INLINE std::array<T, N> deviator(std::array<T, N> t) {
  const T mean = trace(t) / 3;
  for (int i = 0; i < 3; ++i) t[i] -= mean;
  return t;
}

/// t:t, each shear component counted twice.
template <class T, std::size_t N>
QUICKSAND_INLINE T contracted(const std::array<T, N>& t) {
  T sum{};
  for (std::size_t i = 0; i < N; ++i) sum += (i < 3 ? 1.0 : 2.0) * t[i] * t[i];
  return sum;
}

/// The velocity gradient without the stretch that a finite rotation leaves in it, L − ½ Δt W²: what T. J. R.
/// Hughes and J. Winget, IJNME 15 (1980) 1862, get from the middle of the motion, but for second order in the
/// strain.
template <int D, class T>
QUICKSAND_INLINE Gradient<D, T> midpoint_gradient(const Gradient<D, T>& l, double dt) {
  Gradient<D, T> spin, middle = l;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) spin[i][j] = 0.5 * (l[i][j] - l[j][i]);
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j)
      for (int k = 0; k < D; ++k) middle[i][j] -= 0.5 * dt * spin[i][k] * spin[k][j];
  return middle;
}

/// Volume after a step over that before, det(1 + Δt L).
template <int D, class T>
QUICKSAND_INLINE T volume_ratio(const Gradient<D, T>& l, double dt) {
  Gradient<D, T> f;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) f[i][j] = (i == j ? 1.0 : 0.0) + dt * l[i][j];
  const T minor = f[0][0] * f[1][1] - f[0][1] * f[1][0];
  if constexpr (D == 2)
    return minor;
  else
    return f[2][2] * minor - f[2][1] * (f[0][0] * f[1][2] - f[0][2] * f[1][0]) +
           f[2][0] * (f[0][1] * f[1][2] - f[0][2] * f[1][1]);
}

/// Strain of a step of dt seconds; in the plane the third strain grows at the rate `hoop`, 1/s.
template <int D, class T>
QUICKSAND_INLINE Strain<D, T> strain_increment(const Gradient<D, T>& l, double dt,
                                               [[maybe_unused]] const T& hoop) {
  if constexpr (D == 2)
    return {l[0][0] * dt, l[1][1] * dt, hoop * dt, 0.5 * (l[0][1] + l[1][0]) * dt};
  else
    return {l[0][0] * dt,
            l[1][1] * dt,
            l[2][2] * dt,
            0.5 * (l[0][1] + l[1][0]) * dt,
            0.5 * (l[1][2] + l[2][1]) * dt,
            0.5 * (l[2][0] + l[0][2]) * dt};
}

/// a·S·b
template <class T>
QUICKSAND_INLINE T between(const Stress<3, T>& s, const std::array<T, 3>& a, const std::array<T, 3>& b) {
  return a[0] * (s[0] * b[0] + s[3] * b[1] + s[5] * b[2]) + a[1] * (s[3] * b[0] + s[1] * b[1] + s[4] * b[2]) +
         a[2] * (s[5] * b[0] + s[4] * b[1] + s[2] * b[2]);
}

/// Stress carried along with the material's spin over dt seconds (Jaumann rate), by the rotation
/// (1 − ½W)⁻¹(1 + ½W), which keeps its invariants.
template <int D, class T>
QUICKSAND_INLINE Stress<D, T> rotated(const Stress<D, T>& stress, const Gradient<D, T>& l, double dt) {
  if constexpr (D == 2) {
    const T w = 0.25 * (l[1][0] - l[0][1]) * dt;  // tangent of half the angle
    const T f = 1.0 / (1.0 + w * w), c = (1.0 - w * w) * f, sn = 2.0 * w * f;
    const T mean = 0.5 * (stress[0] + stress[1]), half = 0.5 * (stress[0] - stress[1]);
    const T cc = c * c - sn * sn, ss = 2.0 * c * sn;
    const T turned = cc * half - ss * stress[3];
    return {mean + turned, mean - turned, stress[2], ss * half + cc * stress[3]};
  } else {
    // 1 + (W + ½W²)/(1 + ¼|w|²) with W's axial vector w, W² = w wᵀ − |w|².
    const T x = 0.5 * dt * (l[2][1] - l[1][2]), y = 0.5 * dt * (l[0][2] - l[2][0]),
            z = 0.5 * dt * (l[1][0] - l[0][1]);
    const T square = x * x + y * y + z * z, f = 1.0 / (1.0 + 0.25 * square), g = 0.5 * f;
    const std::array<T, 3> r0{1.0 + g * (x * x - square), f * -z + g * x * y, f * y + g * x * z};
    const std::array<T, 3> r1{f * z + g * x * y, 1.0 + g * (y * y - square), f * -x + g * y * z};
    const std::array<T, 3> r2{f * -y + g * x * z, f * x + g * y * z, 1.0 + g * (z * z - square)};
    return {between<T>(stress, r0, r0), between<T>(stress, r1, r1), between<T>(stress, r2, r2),
            between<T>(stress, r0, r1), between<T>(stress, r1, r2), between<T>(stress, r2, r0)};
  }
}

/// At least the largest principal value, and at most the smallest; in the plane these themselves.
template <class T>
struct PrincipalBounds {
  T largest, smallest;
};
template <int D, class T>
QUICKSAND_INLINE PrincipalBounds<T> principal_bounds(const Stress<D, T>& s) {
  const T mean = D == 2 ? 0.5 * (s[0] + s[1]) : trace(s) / 3;
  if constexpr (D == 2) {
    const T half = 0.5 * (s[0] - s[1]), radius = square_root(half * half + s[3] * s[3]);
    const T larger = mean + radius, smaller = mean - radius;
    return {where(larger > s[2], larger, s[2]), where(smaller < s[2], smaller, s[2])};
  } else {
    const T reach = square_root(2.0 / 3.0 * contracted(deviator(s)));
    return {mean + reach, mean - reach};
  }
}

/// Principal values in descending order, and where they point.
template <int D>
struct Principal;
/// In the plane z is principal; the other two are given by twice the angle of the larger one from x.
template <>
struct Principal<2> {
  std::array<double, 3> value;
  std::array<int, 3> place;  ///< in `value`, of the larger and the smaller one in the plane and of z
  double cos2, sin2;
};
template <>
struct Principal<3> {
  std::array<double, 3> value;
  Eigen::Matrix3d direction;  ///< columns
};

inline Principal<2> principal(const Stress<2>& s) {
  const double mean = 0.5 * (s[0] + s[1]), half = 0.5 * (s[0] - s[1]);
  const double radius = std::sqrt(half * half + s[3] * s[3]), larger = mean + radius, smaller = mean - radius;
  const double cos2 = radius > 0 ? half / radius : 1, sin2 = radius > 0 ? s[3] / radius : 0;
  if (s[2] >= larger) return {{s[2], larger, smaller}, {1, 2, 0}, cos2, sin2};
  if (s[2] >= smaller) return {{larger, s[2], smaller}, {0, 2, 1}, cos2, sin2};
  return {{larger, smaller, s[2]}, {0, 1, 2}, cos2, sin2};
}
Principal<3> principal(const Stress<3>& s);

/// The tensor with other principal values in the same directions.
inline Stress<2> with_values(const Principal<2>& p, const std::array<double, 3>& value) {
  const double larger = value[p.place[0]], smaller = value[p.place[1]];
  const double mean = 0.5 * (larger + smaller), radius = 0.5 * (larger - smaller);
  return {mean + radius * p.cos2, mean - radius * p.cos2, value[p.place[2]], radius * p.sin2};
}
Stress<3> with_values(const Principal<3>& p, const std::array<double, 3>& value);

}  // namespace quicksand
