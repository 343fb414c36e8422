// The return of principal stresses against closed forms, and what must hold for any trial.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "tests/engine/materials/mohr_coulomb_law.hpp"

namespace quicksand {
namespace {

using test::kElastic;
using test::law;
using test::yield;
using Principal = std::array<double, 3>;

void expect_stress(const Principal& stress, const Principal& expected, double tolerance) {
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(stress[a], expected[a], tolerance) << a;
}

/// Trial less the elastic stress of the plastic strain: what the returned stress has to be.
Principal after_plastic_strain(const Principal& trial, const Principal& strain) {
  const double volume = strain[0] + strain[1] + strain[2];
  Principal s;
  for (int a = 0; a < 3; ++a) s[a] = trial[a] - kElastic.lame() * volume - 2 * kElastic.shear * strain[a];
  return s;
}

TEST(Elastic, FromYoungsModulus) {
  EXPECT_NEAR(kElastic.shear, 1e7 / 2.6, 1e-6);
  EXPECT_NEAR(kElastic.bulk, 1e7 / 1.2, 1e-6);
  EXPECT_NEAR(kElastic.constrained(), 1e7 * 0.7 / (1.3 * 0.4), 1e-6);
  EXPECT_NEAR(kElastic.lame(), 1e7 * 0.3 / (1.3 * 0.4), 1e-6);
}

TEST(MohrCoulomb, InsideNothingChanges) {
  const MohrCoulomb m = law(30, 10, 1000);
  for (const Principal& trial :
       {Principal{-1e5, -1.5e5, -2e5}, Principal{0, 0, 0}, Principal{500, 0, -500}}) {
    ASSERT_LT(yield(m, trial), 0);
    const auto r = return_map(m, kElastic, trial);
    EXPECT_EQ(r.region, YieldRegion::elastic);
    EXPECT_EQ(r.stress, trial);
    EXPECT_EQ(r.plastic_strain, Principal{});
  }
}

TEST(MohrCoulomb, FaceReturnIsTheClosedForm) {
  const MohrCoulomb m = law(30, 10, 1000);
  const double g = kElastic.shear, k = kElastic.bulk, psi = m.sin_psi;
  const Principal trial{-2e4, -1.2e5, -2.5e5};
  // E. A. de Souza Neto et al., eqs. 8.66-8.69, with a linear cohesion.
  const double gamma = yield(m, trial) / (4 * g * (1 + m.sin_phi * psi / 3) + 4 * k * m.sin_phi * psi);
  const auto r = return_map(m, kElastic, trial);
  EXPECT_EQ(r.region, YieldRegion::face);
  expect_stress(
      r.stress,
      {trial[0] - (2 * g * (1 + psi / 3) + 2 * k * psi) * gamma, trial[1] + (4 * g / 3 - 2 * k) * psi * gamma,
       trial[2] + (2 * g * (1 - psi / 3) - 2 * k * psi) * gamma},
      1e-8);
  EXPECT_NEAR(yield(m, r.stress), 0, 1e-8);
}

TEST(MohrCoulomb, DilationOnTheFaceFollowsThePotential) {
  for (const double psi : {0.0, 5.0, 20.0}) {
    const auto r = return_map(law(30, psi, 1000), kElastic, {-2e4, -1.2e5, -2.5e5});
    ASSERT_EQ(r.region, YieldRegion::face);
    const auto& e = r.plastic_strain;
    EXPECT_NEAR((e[0] + e[1] + e[2]) / (e[0] - e[2]), std::sin(psi * std::numbers::pi / 180), 1e-12);
    EXPECT_EQ(e[1], 0);
    EXPECT_GT(e[0], 0);
  }
}

TEST(MohrCoulomb, EdgeOfTriaxialCompression) {
  const MohrCoulomb m = law(30, 10, 1000);
  const double psi = m.sin_psi;
  const Principal trial{-5e4, -5e4, -3e5};
  // Both faces carry the same multiplier: σ1 = σ2 drops by λ·4 sin ψ γ + 2G (1 + sin ψ) γ.
  const double major = 4 * kElastic.lame() * psi + 2 * kElastic.shear * (1 + psi);
  const double minor = 4 * kElastic.lame() * psi - 4 * kElastic.shear * (1 - psi);
  const double gamma = yield(m, trial) / (major - minor + (major + minor) * m.sin_phi);
  const auto r = return_map(m, kElastic, trial);
  EXPECT_EQ(r.region, YieldRegion::edge_compression);
  expect_stress(r.stress, {trial[0] - major * gamma, trial[1] - major * gamma, trial[2] - minor * gamma},
                1e-8);
}

TEST(MohrCoulomb, EdgeOfTriaxialExtension) {
  const MohrCoulomb m = law(30, 10, 1000);
  const double psi = m.sin_psi;
  const Principal trial{-2e4, -3e5, -3e5};
  const double minor = 4 * kElastic.lame() * psi - 2 * kElastic.shear * (1 - psi);
  const double major = 4 * kElastic.lame() * psi + 4 * kElastic.shear * (1 + psi);
  const double gamma = yield(m, trial) / (major - minor + (major + minor) * m.sin_phi);
  const auto r = return_map(m, kElastic, trial);
  EXPECT_EQ(r.region, YieldRegion::edge_extension);
  expect_stress(r.stress, {trial[0] - major * gamma, trial[1] - minor * gamma, trial[2] - minor * gamma},
                1e-8);
}

TEST(MohrCoulomb, EdgesOfUnequalTrialsLieOnBothFaces) {
  const MohrCoulomb m = law(30, 10, 1000);
  const auto low = return_map(m, kElastic, {-5e4, -5.5e4, -3e5});
  EXPECT_EQ(low.region, YieldRegion::edge_compression);
  EXPECT_NEAR(low.stress[0], low.stress[1], 1e-8);
  EXPECT_NEAR(yield(m, low.stress), 0, 1e-8);
  const auto high = return_map(m, kElastic, {-2e4, -2.95e5, -3e5});
  EXPECT_EQ(high.region, YieldRegion::edge_extension);
  EXPECT_NEAR(high.stress[1], high.stress[2], 1e-8);
  EXPECT_NEAR(yield(m, high.stress), 0, 1e-8);
}

TEST(MohrCoulomb, TensionReturnsToTheApex) {
  const MohrCoulomb m = law(30, 10, 1000);
  const double apex = 1000 / std::tan(std::numbers::pi / 6);
  const auto r = return_map(m, kElastic, {5e4, 5e4, 5e4});
  EXPECT_EQ(r.region, YieldRegion::apex);
  expect_stress(r.stress, {apex, apex, apex}, 1e-9);
  for (double e : r.plastic_strain) EXPECT_NEAR(e, (5e4 - apex) / (3 * kElastic.bulk), 1e-15);
  EXPECT_EQ(return_map(m, kElastic, {6e4, 5.9e4, 5.7e4}).region, YieldRegion::apex);
}

TEST(MohrCoulomb, WithoutCohesionZeroStressStaysAndTensionVanishes) {
  const MohrCoulomb m = law(35, 0, 0);
  const auto rest = return_map(m, kElastic, {0, 0, 0});
  EXPECT_EQ(rest.region, YieldRegion::elastic);
  EXPECT_EQ(rest.stress, Principal{});
  for (const Principal& trial : {Principal{100, 100, 100}, Principal{100, 50, 20}, Principal{1e-300, 0, 0}}) {
    const auto r = return_map(m, kElastic, trial);
    expect_stress(r.stress, {0, 0, 0}, 1e-12 * trial[0]);
    for (double e : r.plastic_strain) EXPECT_TRUE(std::isfinite(e));
  }
}

TEST(MohrCoulomb, WithoutFrictionItIsTresca) {
  const MohrCoulomb m = law(0, 0, 1000);
  for (const double mean : {-1e6, 0.0, 1e6}) {  // strength and return do not depend on the mean stress
    const auto face = return_map(m, kElastic, {mean + 4000, mean, mean - 4000});
    EXPECT_EQ(face.region, YieldRegion::face);
    expect_stress(face.stress, {mean + 1000, mean, mean - 1000}, 1e-6);
    const auto edge = return_map(m, kElastic, {mean + 3000, mean + 3000, mean - 6000});
    EXPECT_EQ(edge.region, YieldRegion::edge_compression);
    expect_stress(edge.stress, {mean + 2000.0 / 3, mean + 2000.0 / 3, mean - 4000.0 / 3}, 1e-6);
  }
}

/// Runs `check` on 10⁵ random soils and trials; an eighth of them near zero or tension.
void for_random_trials(const std::function<void(const MohrCoulomb&, const Principal&)>& check) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> part(0, 1);
  std::normal_distribution<double> spread(0, 1);
  for (int i = 0; i < 100000; ++i) {
    const double phi = i % 10 == 0 ? 0 : 45 * part(random);
    const MohrCoulomb m = law(phi, phi * part(random) * (i % 3 > 0), i % 4 == 0 ? 0 : 2e4 * part(random));
    const double size = std::pow(10, 6 * part(random)), mean = i % 8 == 0 ? size : -size * 2 * part(random);
    Principal trial;
    for (double& s : trial) s = mean + size * spread(random);
    std::sort(trial.begin(), trial.end(), std::greater<>());
    check(m, trial);
  }
}

double scale(const MohrCoulomb& m, const Principal& s) {
  return std::abs(s[0]) + std::abs(s[1]) + std::abs(s[2]) + m.cohesion;
}

TEST(MohrCoulomb, AnyReturnIsAdmissibleSortedAndFinal) {
  std::array<int, 5> regions{};
  int bad = 0;
  for_random_trials([&](const MohrCoulomb& m, const Principal& trial) {
    const auto r = return_map(m, kElastic, trial);
    ++regions[static_cast<int>(r.region)];
    const double tolerance = 1e-11 * scale(m, trial);
    bool good = yield(m, r.stress) <= tolerance && r.stress[0] >= r.stress[1] - tolerance &&
                r.stress[1] >= r.stress[2] - tolerance;
    if (r.region != YieldRegion::elastic)
      good = good && yield(m, r.stress) >= -tolerance;  // onto the surface
    Principal again = r.stress;
    std::sort(again.begin(), again.end(), std::greater<>());
    const auto twice = return_map(m, kElastic, again);
    for (int a = 0; a < 3; ++a) good = good && std::abs(twice.stress[a] - again[a]) <= tolerance;
    bad += !good;
  });
  EXPECT_EQ(bad, 0);
  for (int n : regions) EXPECT_GT(n, 1000);  // every region was met
}

TEST(MohrCoulomb, StressDropIsThePlasticStrainsAndWorkIsLost) {
  int inconsistent = 0, negative = 0;
  for_random_trials([&](const MohrCoulomb& m, const Principal& trial) {
    const auto r = return_map(m, kElastic, trial);
    const Principal expected = after_plastic_strain(trial, r.plastic_strain);
    double work = 0, size = 0;
    for (int a = 0; a < 3; ++a) {
      inconsistent += std::abs(expected[a] - r.stress[a]) > 1e-11 * scale(m, trial);
      work += r.stress[a] * r.plastic_strain[a];
      size += std::abs(r.stress[a] * r.plastic_strain[a]);
    }
    negative += work < -1e-9 * size - 1e-15 * scale(m, trial) * scale(m, trial) / kElastic.bulk;
  });
  EXPECT_EQ(inconsistent, 0);
  EXPECT_EQ(negative, 0);
}

TEST(MohrCoulomb, ReturnScalesWithTheStress) {
  const Principal trial{-2e4, -1.2e5, -2.5e5};
  const auto one = return_map(law(30, 10, 1000), kElastic, trial);
  for (const double factor : {1e-6, 1e6}) {
    const Elastic e{kElastic.shear * factor, kElastic.bulk * factor};
    const auto r =
        return_map(law(30, 10, 1000 * factor), e, {trial[0] * factor, trial[1] * factor, trial[2] * factor});
    EXPECT_EQ(r.region, one.region);
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(r.stress[a] / factor, one.stress[a], 1e-6);
  }
}

}  // namespace
}  // namespace quicksand
