#include "engine/materials/tensor.hpp"

#include <Eigen/Eigenvalues>

namespace quicksand {
namespace {

using Matrix = Eigen::Matrix3d;

Matrix to_matrix(const Stress<3>& s) {
  Matrix m;
  m << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return m;
}

/// a·S·b
double between(const Stress<3>& s, const Vec<3>& a, const Vec<3>& b) {
  return a[0] * (s[0] * b[0] + s[3] * b[1] + s[5] * b[2]) + a[1] * (s[3] * b[0] + s[1] * b[1] + s[4] * b[2]) +
         a[2] * (s[5] * b[0] + s[4] * b[1] + s[2] * b[2]);
}

/// What is left of an eigenvector that the closed form may be off by, of the largest entry.
constexpr double kDirect = 1e-11;

}  // namespace

Stress<3> rotated_in_space(const Stress<3>& stress, const Gradient<3>& l, double dt) {
  // (1 − ½W)⁻¹(1 + ½W) = 1 + (W + ½W²)/(1 + ¼|w|²) with W's axial vector w, W² = w wᵀ − |w|².
  const double x = 0.5 * dt * (l[2][1] - l[1][2]), y = 0.5 * dt * (l[0][2] - l[2][0]),
               z = 0.5 * dt * (l[1][0] - l[0][1]);
  const double square = x * x + y * y + z * z, f = 1 / (1 + 0.25 * square), g = 0.5 * f;
  const Vec<3> r0{1 + g * (x * x - square), f * -z + g * x * y, f * y + g * x * z};
  const Vec<3> r1{f * z + g * x * y, 1 + g * (y * y - square), f * -x + g * y * z};
  const Vec<3> r2{f * -y + g * x * z, f * x + g * y * z, 1 + g * (z * z - square)};
  return {between(stress, r0, r0), between(stress, r1, r1), between(stress, r2, r2),
          between(stress, r0, r1), between(stress, r1, r2), between(stress, r2, r0)};
}

Principal<3> principal(const Stress<3>& s) {
  const Matrix m = to_matrix(s);
  Eigen::SelfAdjointEigenSolver<Matrix> solver;
  solver.computeDirect(m);  // several times as fast, but not sure where values are close
  const Matrix& v = solver.eigenvectors();
  const double size = m.cwiseAbs().maxCoeff();
  const bool good = (m * v - v * solver.eigenvalues().asDiagonal()).cwiseAbs().maxCoeff() <= kDirect * size &&
                    (v.transpose() * v - Matrix::Identity()).cwiseAbs().maxCoeff() <= kDirect;
  if (!good) solver.compute(m);
  Principal<3> p;
  for (int i = 0; i < 3; ++i) {
    p.value[i] = solver.eigenvalues()(2 - i);
    p.direction.col(i) = solver.eigenvectors().col(2 - i);
  }
  return p;
}

Stress<3> with_values(const Principal<3>& p, const std::array<double, 3>& value) {
  const auto entry = [&](int a, int b) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += value[i] * p.direction(a, i) * p.direction(b, i);
    return sum;
  };
  return {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(2, 0)};
}

}  // namespace quicksand
