#pragma once
// Symmetric tensors as points hold them, xx yy zz xy [yz zx] with tensor (not engineering) shear components.

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "engine/grid/lanes.hpp"
#include "engine/points/points.hpp"

namespace quicksand {

/// Velocity gradient, ∂v_i/∂x_j in 1/s.
template <int D>
using Gradient = std::array<Vec<D>, D>;
template <int D>
using Strain = Stress<D>;

template <std::size_t N>
double trace(const std::array<double, N>& t) {
  return t[0] + t[1] + t[2];
}

template <std::size_t N>
std::array<double, N> deviator(std::array<double, N> t) {
  const double mean = trace(t) / 3;
  for (int i = 0; i < 3; ++i) t[i] -= mean;
  return t;
}

/// t:t, each shear component counted twice.
template <std::size_t N>
double contracted(const std::array<double, N>& t) {
  double sum = 0;
  for (std::size_t i = 0; i < N; ++i) sum += (i < 3 ? 1 : 2) * t[i] * t[i];
  return sum;
}

/// The velocity gradient without the stretch that a finite rotation leaves in it, L − ½ Δt W²: what T. J. R.
/// Hughes and J. Winget, IJNME 15 (1980) 1862, get from the middle of the motion, but for second order in the
/// strain.
template <int D>
Gradient<D> midpoint_gradient(const Gradient<D>& l, double dt) {
  const auto spin = [&](int i, int j) { return 0.5 * (l[i][j] - l[j][i]); };
  Gradient<D> middle = l;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j)
      for (int k = 0; k < D; ++k) middle[i][j] -= 0.5 * dt * spin(i, k) * spin(k, j);
  return middle;
}

/// Volume after a step over that before, det(1 + Δt L).
template <int D>
double volume_ratio(const Gradient<D>& l, double dt) {
  const auto f = [&](int i, int j) { return (i == j ? 1 : 0) + dt * l[i][j]; };
  const auto minor = [&](int i, int j) { return f(0, i) * f(1, j) - f(0, j) * f(1, i); };
  if constexpr (D == 2)
    return minor(0, 1);
  else
    return f(2, 2) * minor(0, 1) - f(2, 1) * minor(0, 2) + f(2, 0) * minor(1, 2);
}

/// Strain of a step of dt seconds; in the plane the third strain grows at the rate `hoop`, 1/s.
template <int D>
Strain<D> strain_increment(const Gradient<D>& l, double dt, [[maybe_unused]] double hoop) {
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

/// Stress carried along with the material's spin over dt seconds (Jaumann rate), by the rotation
/// (1 − ½W)⁻¹(1 + ½W), which keeps its invariants.
Stress<3> rotated_in_space(const Stress<3>& stress, const Gradient<3>& l, double dt);
template <int D>
Stress<D> rotated(const Stress<D>& stress, const Gradient<D>& l, double dt) {
  if constexpr (D == 2) {
    const double w = 0.25 * (l[1][0] - l[0][1]) * dt;  // tangent of half the angle
    const double c = (1 - w * w) / (1 + w * w), sn = 2 * w / (1 + w * w);
    const double mean = 0.5 * (stress[0] + stress[1]), half = 0.5 * (stress[0] - stress[1]);
    const double cc = c * c - sn * sn, ss = 2 * c * sn;
    const double turned = cc * half - ss * stress[3];
    return {mean + turned, mean - turned, stress[2], ss * half + cc * stress[3]};
  } else {
    return rotated_in_space(stress, l, dt);
  }
}

/// At least the largest principal value, and at most the smallest; in the plane these themselves.
struct PrincipalBounds {
  double largest, smallest;
};
template <int D>
PrincipalBounds principal_bounds(const Stress<D>& s) {
  if constexpr (D == 2) {
    const double mean = 0.5 * (s[0] + s[1]), half = 0.5 * (s[0] - s[1]);
    const double radius = std::sqrt(half * half + s[3] * s[3]);
    return {std::max(mean + radius, s[2]), std::min(mean - radius, s[2])};
  } else {
    const double reach = std::sqrt(2.0 / 3.0 * contracted(deviator(s))), mean = trace(s) / 3;
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
