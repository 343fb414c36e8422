// Stress update of a point: objectivity, elasticity, plane strain and the drag of the soil.

#include "engine/materials/soil_material.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "tests/engine/small_scene.hpp"

namespace quicksand {
namespace {

SoilMaterial soil(SoilLaw law, double cohesion = 1000) {
  Soil s = test::sand();
  s.model.law = law;
  s.model.cohesion = cohesion;
  s.model.dilation_angle = 8;
  return SoilMaterial::from(s, {});
}

/// Stress after a step, and the growth of the plastic strain.
template <int D>
struct StressUpdate {
  Stress<D> stress;
  double plastic_strain;
};
template <int D>
StressUpdate<D> update_stress(const SoilMaterial& material, const Stress<D>& stress, const Gradient<D>& l,
                              double dt) {
  SoilState<D> state{stress};
  EXPECT_EQ(update_state<D>(material, state, material.porosity, l, dt), 0);
  return {state.stress, state.plastic_strain};
}

const Elastic& elastic(const SoilMaterial& material) {
  const auto* mohr_coulomb = std::get_if<MohrCoulombLaw>(&material.law);
  return mohr_coulomb ? mohr_coulomb->elastic : std::get<LinearElasticLaw>(material.law).elastic;
}

Eigen::Matrix3d tensor(const Stress<2>& s) {
  Eigen::Matrix3d m;
  m << s[0], s[3], 0, s[3], s[1], 0, 0, 0, s[2];
  return m;
}
Eigen::Matrix3d tensor(const Stress<3>& s) {
  Eigen::Matrix3d m;
  m << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return m;
}
template <int D>
Stress<D> components(const Eigen::Matrix3d& m) {
  if constexpr (D == 2)
    return {m(0, 0), m(1, 1), m(2, 2), m(0, 1)};
  else
    return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(2, 0)};
}
template <int D>
Gradient<D> gradient(const Eigen::Matrix3d& m) {
  Gradient<D> l;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) l[i][j] = m(i, j);
  return l;
}

template <int D>
Eigen::Matrix3d random_rotation(std::mt19937& random) {
  std::normal_distribution<double> n(0, 1);
  if constexpr (D == 3)
    return Eigen::Quaterniond(n(random), n(random), n(random), n(random)).normalized().matrix();
  return Eigen::AngleAxisd(3 * n(random), Eigen::Vector3d::UnitZ()).matrix();
}
template <int D>
Eigen::Matrix3d random_matrix(std::mt19937& random, double size) {
  std::normal_distribution<double> n(0, size);
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) m(i, j) = n(random);
  return m;
}

template <int D>
void expect_same_in_turned_axes() {
  const SoilMaterial material = soil(SoilLaw::mohr_coulomb);
  std::mt19937 random(5);
  int yielded = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Matrix3d r = random_rotation<D>(random);
    Eigen::Matrix3d s = random_matrix<D>(random, 3e4);
    s = (s + s.transpose()).eval() - 5e4 * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d l = random_matrix<D>(random, 1);
    const double dt = 5e-3;
    const auto straight = update_stress<D>(material, components<D>(s), gradient<D>(l), dt);
    const auto turned = update_stress<D>(material, components<D>(r * s * r.transpose()),
                                         gradient<D>(r * l * r.transpose()), dt);
    const Eigen::Matrix3d expected = r * tensor(straight.stress) * r.transpose();
    EXPECT_LT((tensor(turned.stress) - expected).norm(), 1e-9 * (1 + s.norm()));
    EXPECT_NEAR(turned.plastic_strain, straight.plastic_strain, 1e-12);
    yielded += straight.plastic_strain > 0;
  }
  EXPECT_GT(yielded, 500);
  EXPECT_LT(yielded, 1990);
}

TEST(UpdateStress, DoesNotDependOnTheAxes2D) { expect_same_in_turned_axes<2>(); }
TEST(UpdateStress, DoesNotDependOnTheAxes3D) { expect_same_in_turned_axes<3>(); }

/// Largest difference, relative to the stress, from the stress turned by 90° in `steps` steps.
template <int D>
double rotation_error(int steps) {
  const SoilMaterial material = soil(SoilLaw::linear_elastic);
  Stress<D> s{};
  s[0] = -1e5, s[1] = -3e5, s[2] = -2e5, s[3] = 4e4;
  const Eigen::Matrix3d start = tensor(s);
  // Turns about z at 1 rad/s: the gradient of the chords along which points move in a step.
  const double dt = 0.5 * std::numbers::pi / steps;
  Gradient<D> l{};
  l[0][0] = l[1][1] = (std::cos(dt) - 1) / dt;
  l[1][0] = std::sin(dt) / dt, l[0][1] = -l[1][0];
  for (int i = 0; i < steps; ++i) s = update_stress<D>(material, s, l, dt).stress;
  const Eigen::Matrix3d r = Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ()).matrix();
  EXPECT_NEAR(tensor(s).trace(), start.trace(), 1e-7 * std::abs(start.trace()));
  return (tensor(s) - r * start * r.transpose()).norm() / start.norm();
}

TEST(UpdateStress, RigidRotationTurnsTheStress) {  // Jaumann rate
  const double coarse = rotation_error<2>(1000), fine = rotation_error<2>(2000);
  EXPECT_LT(coarse, 2e-6);
  EXPECT_NEAR(coarse / fine, 4, 0.2);  // second order
  EXPECT_NEAR(rotation_error<3>(1000), coarse, 1e-9);
}

TEST(UpdateStress, RigidRotationNeverYields) {
  const SoilMaterial material = soil(SoilLaw::mohr_coulomb);
  Stress<2> s{-1e5, -2.0e5, -1.2e5, 0};
  Gradient<2> l{};
  l[0][1] = -1, l[1][0] = 1;
  double plastic = 0;
  for (int i = 0; i < 10000; ++i) {
    const auto u = update_stress<2>(material, s, l, 1e-4);
    s = u.stress;
    plastic += u.plastic_strain;
  }
  EXPECT_EQ(plastic, 0);
}

TEST(UpdateStress, OneDimensionalCompressionIsTheConstrainedModulus) {
  const SoilMaterial material = soil(SoilLaw::linear_elastic);
  Gradient<2> l{};
  l[1][1] = -1;
  const auto u = update_stress<2>(material, {}, l, 1e-3);
  EXPECT_NEAR(u.stress[1], -1e-3 * elastic(material).constrained(), 1e-8);
  EXPECT_NEAR(u.stress[0], -1e-3 * elastic(material).lame(), 1e-8);
  EXPECT_NEAR(u.stress[2], u.stress[0], 1e-8);  // the plane's third strain is zero
  EXPECT_EQ(u.stress[3], 0);
}

TEST(UpdateStress, SimpleShearIsTheShearModulus) {
  const SoilMaterial material = soil(SoilLaw::linear_elastic);
  Gradient<3> l{};
  l[1][2] = 1;
  const auto u = update_stress<3>(material, {}, l, 1e-3);
  EXPECT_NEAR(u.stress[4], 1e-3 * elastic(material).shear, 1e-8);
  // The rest is the stretch of a finite shear, second order in it.
  for (int i : {0, 1, 2, 3, 5}) EXPECT_LT(std::abs(u.stress[i]), 1e-3 * u.stress[4]) << i;
}

TEST(UpdateStress, ThePlaneIsSpaceWithoutThirdStrain) {
  const SoilMaterial material = soil(SoilLaw::mohr_coulomb);
  std::mt19937 random(6);
  for (int i = 0; i < 500; ++i) {
    Eigen::Matrix3d s = random_matrix<2>(random, 3e4);
    s = (s + s.transpose()).eval() - 5e4 * Eigen::Matrix3d::Identity();
    s(2, 2) += 2e4 * std::sin(i);  // major, intermediate and minor in turn
    const Eigen::Matrix3d l = random_matrix<2>(random, 1);
    const auto plane = update_stress<2>(material, components<2>(s), gradient<2>(l), 5e-3);
    const auto space = update_stress<3>(material, components<3>(s), gradient<3>(l), 5e-3);
    EXPECT_LT((tensor(plane.stress) - tensor(space.stress)).norm(), 1e-9 * s.norm());
    EXPECT_NEAR(plane.plastic_strain, space.plastic_strain, 1e-12);
  }
}

TEST(UpdateStress, ActiveFailureOfSandLiesAtRankinesRatio) {
  const SoilMaterial material = soil(SoilLaw::mohr_coulomb, 0);
  Stress<2> s{-5e4, -1e5, -5e4, 0};
  Gradient<2> l{};
  l[0][0] = 1;  // stretched sideways
  double plastic = 0;
  for (int i = 0; i < 100; ++i) {
    const auto u = update_stress<2>(material, s, l, 1e-4);
    s = u.stress;
    plastic += u.plastic_strain;
  }
  EXPECT_NEAR(s[0] / s[1], 1.0 / 3, 1e-9);  // Ka = (1 − sin 30°)/(1 + sin 30°)
  EXPECT_GT(plastic, 1e-3);
}

TEST(UpdateStress, PlasticShearStrainIsTheDeviatorsNorm) {
  // Without dilation and with all of the strain plastic: √(2/3 e:e) of a pure shear γ is γ/√3.
  Soil s = test::sand();
  s.model.friction_angle = 0, s.model.cohesion = 1000;
  const SoilMaterial material = SoilMaterial::from(s, {});
  Stress<2> stress{0, 0, 0, 1000};
  Gradient<2> l{};
  l[0][1] = l[1][0] = 0.5;  // no spin
  const auto u = update_stress<2>(material, stress, l, 1e-3);
  EXPECT_NEAR(u.stress[3], 1000, 1e-8);
  EXPECT_NEAR(u.plastic_strain, 1e-3 / std::sqrt(3), 1e-12);
}

TEST(SoilMaterial, TakesWhatTheSceneSays) {
  Soil s = test::sand();
  EXPECT_EQ(SoilMaterial::from(s, {}).max_porosity, 1);
  s.max_porosity = 0.47;
  const SoilMaterial m = SoilMaterial::from(s, {});
  EXPECT_EQ(m.max_porosity, 0.47);
  EXPECT_EQ(m.grain_density, 2650);
  EXPECT_EQ(m.porosity, 0.4);
  const MohrCoulomb& strength = std::get<MohrCoulombLaw>(m.law).peak;
  EXPECT_NEAR(strength.sin_phi, 0.5, 1e-15);
  EXPECT_NEAR(strength.cos_phi, std::sqrt(0.75), 1e-15);
}

}  // namespace
}  // namespace quicksand
