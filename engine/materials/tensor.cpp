#include "engine/materials/tensor.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace quicksand {
namespace {

using Matrix = Eigen::Matrix3d;

template <int D>
Matrix to_matrix(const Stress<D>& s) {
  Matrix m = Matrix::Zero();
  m(0, 0) = s[0], m(1, 1) = s[1], m(2, 2) = s[2];
  m(0, 1) = m(1, 0) = s[3];
  if constexpr (D == 3) {
    m(1, 2) = m(2, 1) = s[4];
    m(2, 0) = m(0, 2) = s[5];
  }
  return m;
}

template <int D>
Stress<D> to_stress(const Matrix& m) {
  if constexpr (D == 2)
    return {m(0, 0), m(1, 1), m(2, 2), m(0, 1)};
  else
    return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(2, 0)};
}

/// Closed form for the plane: z is principal, the other two are a rotation in the plane.
Principal principal_plane(const Stress<2>& s) {
  const double mean = 0.5 * (s[0] + s[1]), half = 0.5 * (s[0] - s[1]);
  const double radius = std::sqrt(half * half + s[3] * s[3]);
  // cos and sin of half the angle of (half, xy), the larger one first so that nothing cancels.
  double c = 1, sn = 0;
  if (radius > 0) {
    const double larger = std::sqrt(0.5 * (1 + std::abs(half) / radius)),
                 other = s[3] / (2 * radius * larger);
    c = half >= 0 ? larger : std::abs(other);
    sn = half >= 0 ? other : std::copysign(larger, s[3]);
  }
  Principal p;
  std::array<int, 3> column;  // where the in-plane major, in-plane minor and z directions go
  if (s[2] >= mean + radius)
    p.value = {s[2], mean + radius, mean - radius}, column = {1, 2, 0};
  else if (s[2] >= mean - radius)
    p.value = {mean + radius, s[2], mean - radius}, column = {0, 2, 1};
  else
    p.value = {mean + radius, mean - radius, s[2]}, column = {0, 1, 2};
  p.direction.col(column[0]) << c, sn, 0;
  p.direction.col(column[1]) << -sn, c, 0;
  p.direction.col(column[2]) << 0, 0, 1;
  return p;
}

}  // namespace

Stress<3> rotated_in_space(const Stress<3>& stress, const Gradient<3>& l, double dt) {
  Matrix spin = Matrix::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) spin(i, j) = 0.5 * (l[i][j] - l[j][i]) * dt;
  // (1 − ½W)⁻¹(1 + ½W) = 1 + (W + ½W²)/(1 + ¼|w|²), with W's axial vector w: ½ W:W = |w|².
  const double square = 0.5 * spin.squaredNorm();
  const Matrix rotation = Matrix::Identity() + (spin + 0.5 * spin * spin) / (1 + 0.25 * square);
  return to_stress<3>(rotation * to_matrix<3>(stress) * rotation.transpose());
}

template <int D>
Principal principal(const Stress<D>& s) {
  if constexpr (D == 2) {
    return principal_plane(s);
  } else {
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(to_matrix<D>(s));
    Principal p;
    for (int i = 0; i < 3; ++i) {
      p.value[i] = solver.eigenvalues()(2 - i);
      p.direction.col(i) = solver.eigenvectors().col(2 - i);
    }
    return p;
  }
}

template <int D>
Stress<D> with_values(const Principal& p, const std::array<double, 3>& value) {
  const Matrix m =
      p.direction * Eigen::Vector3d(value[0], value[1], value[2]).asDiagonal() * p.direction.transpose();
  return to_stress<D>(m);
}

template Principal principal<2>(const Stress<2>&);
template Principal principal<3>(const Stress<3>&);
template Stress<2> with_values<2>(const Principal&, const std::array<double, 3>&);
template Stress<3> with_values<3>(const Principal&, const std::array<double, 3>&);

}  // namespace quicksand
