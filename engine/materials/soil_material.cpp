#include "engine/materials/soil_material.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

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

/// Principal stresses in descending order with their directions as columns.
struct Principal {
  std::array<double, 3> value;
  Matrix direction;
};

/// Closed form for the plane: z is principal, the other two are a rotation in the plane.
Principal principal_plane(const Stress<2>& s) {
  const double mean = 0.5 * (s[0] + s[1]), half = 0.5 * (s[0] - s[1]);
  const double radius = std::hypot(half, s[3]);
  const double angle = radius > 0 ? 0.5 * std::atan2(s[3], half) : 0;
  const double c = std::cos(angle), sn = std::sin(angle);
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
Stress<D> elastic_trial(const Elastic& e, const Stress<D>& stress, const Gradient<D>& l, double dt,
                        double hoop) {
  Matrix gradient = Matrix::Zero();
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) gradient(i, j) = l[i][j] * dt;
  if constexpr (D == 2) gradient(2, 2) = hoop * dt;
  const Matrix strain = 0.5 * (gradient + gradient.transpose());
  const Matrix spin = 0.5 * (gradient - gradient.transpose());
  const Matrix s = to_matrix<D>(stress);
  return to_stress<D>(s + spin * s - s * spin + 2 * e.shear * strain +
                      e.lame() * strain.trace() * Matrix::Identity());
}

}  // namespace

SoilMaterial SoilMaterial::from(const Soil& soil, const Water& water) {
  SoilMaterial m;
  const SoilModel& model = soil.model;
  m.law = model.law;
  m.elastic = Elastic::from_young(model.young_modulus, model.poisson_ratio);
  constexpr double kRadians = std::numbers::pi / 180;
  m.mohr_coulomb = {std::sin(model.friction_angle * kRadians), std::cos(model.friction_angle * kRadians),
                    std::sin(model.dilation_angle * kRadians), model.cohesion};
  m.drag = Drag::from(soil, water);
  m.grain_density = soil.grain_density;
  m.porosity = soil.porosity;
  m.max_porosity = soil.max_porosity.value_or(1);
  return m;
}

template <int D>
StressUpdate<D> update_stress(const SoilMaterial& soil, const Stress<D>& stress, const Gradient<D>& l,
                              double dt, double hoop) {
  const Stress<D> trial = elastic_trial<D>(soil.elastic, stress, l, dt, hoop);
  if (soil.law == SoilLaw::linear_elastic) return {trial, 0};

  const Principal p = principal<D>(trial);
  const MohrCoulombReturn r = return_map(soil.mohr_coulomb, soil.elastic, p.value);
  if (r.region == YieldRegion::elastic) return {trial, 0};
  const auto& e = r.plastic_strain;
  const double mean = (e[0] + e[1] + e[2]) / 3;
  const double shear =
      (e[0] - mean) * (e[0] - mean) + (e[1] - mean) * (e[1] - mean) + (e[2] - mean) * (e[2] - mean);
  const Matrix back = p.direction * Eigen::Vector3d(r.stress[0], r.stress[1], r.stress[2]).asDiagonal() *
                      p.direction.transpose();
  return {to_stress<D>(back), std::sqrt(2.0 / 3.0 * shear)};
}

template StressUpdate<2> update_stress<2>(const SoilMaterial&, const Stress<2>&, const Gradient<2>&, double,
                                          double);
template StressUpdate<3> update_stress<3>(const SoilMaterial&, const Stress<3>&, const Gradient<3>&, double,
                                          double);

}  // namespace quicksand
