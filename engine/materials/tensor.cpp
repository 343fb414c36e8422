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

/// What is left of an eigenvector that the closed form may be off by, of the largest entry.
constexpr double kDirect = 1e-11;

}  // namespace

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
