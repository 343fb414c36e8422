// Mohr–Coulomb with a tension cut-off and with softening: closed forms, and what must hold for any trial.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "engine/materials/soil_material.hpp"
#include "tests/engine/materials/mohr_coulomb_law.hpp"
#include "tests/engine/small_scene.hpp"

namespace quicksand {
namespace {

using test::kElastic;
using test::law;
using test::yield;
using Values = std::array<double, 3>;

TEST(TensionCutoff, UniaxialStretchStopsAtTheCutoff) {
  // σ1 alone above T: only ε1 is plastic, σ2 and σ3 fall with Poisson's ratio.
  const MohrCoulomb m = law(30, 0, 1e4, 500);
  const Values trial{1500, -2000, -3000};
  const auto r = return_map(m, kElastic, trial);
  EXPECT_EQ(r.region, YieldRegion::tension);
  const double drop = 1000, side = kElastic.lame() / kElastic.constrained();
  EXPECT_NEAR(r.stress[0], 500, 1e-8);
  EXPECT_NEAR(r.stress[1], -2000 - side * drop, 1e-8);
  EXPECT_NEAR(r.stress[2], -3000 - side * drop, 1e-8);
  EXPECT_NEAR(r.plastic_strain[0], drop / kElastic.constrained(), 1e-15);
  EXPECT_NEAR(std::abs(r.plastic_strain[1]) + std::abs(r.plastic_strain[2]), 0, 1e-15);
}

/// The trial that a plastic strain brings back to `stress`.
Values trial_of(const Values& stress, const std::vector<Values>& flows) {
  Values strain{}, trial;
  for (const Values& f : flows)
    for (int a = 0; a < 3; ++a) strain[a] += f[a];
  for (int a = 0; a < 3; ++a)
    trial[a] =
        stress[a] + 2 * kElastic.shear * strain[a] + kElastic.lame() * (strain[0] + strain[1] + strain[2]);
  return trial;
}

TEST(TensionCutoff, EdgesAndCornersAreExact) {
  const MohrCoulomb m = law(30, 10, 1e4, 500);
  const double least = (500 * 1.5 - 2e4 * m.cos_phi) / 0.5;  // σ3 on the shear face where σ1 = T
  const double up = 1e-4 * (1 + m.sin_psi), down = 1e-4 * (m.sin_psi - 1), t = 2e-4;
  const Values shear_13{up, 0, down}, shear_12{up, down, 0}, shear_23{0, up, down};
  const Values tension_1{t, 0, 0}, tension_2{0, 0.9 * t, 0}, tension_3{0, 0, 0.8 * t};
  struct Corner {
    Values stress;
    std::vector<Values> flows;
  };
  const Corner corners[] = {
      {{500, 500, 500}, {tension_1, tension_2, tension_3}},
      {{500, least, least}, {tension_1, shear_13, shear_12}},
      {{500, 500, least}, {tension_1, tension_2, shear_13}},
      {{500, 500, least}, {tension_1, shear_13, shear_23}},
      {{500, 500, least}, {tension_1, tension_2, shear_13, shear_23}},
      {{500, 500, -1e4}, {tension_1, tension_2}},
      {{500, -1e4, least}, {tension_1, shear_13}},
      {{500, -1e4, -2e4}, {tension_1}},
  };
  for (const Corner& c : corners) {
    const Values trial = trial_of(c.stress, c.flows);
    ASSERT_TRUE(trial[0] >= trial[1] && trial[1] >= trial[2]);
    const auto r = return_map(m, kElastic, trial);
    EXPECT_EQ(r.region, YieldRegion::tension);
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(r.stress[a], c.stress[a], 1e-7) << a;
  }
}

TEST(TensionCutoff, AboveTheApexItChangesNothing) {
  const double apex = law(30, 0, 1e3, 0).apex();
  for (const Values& trial : {Values{9e4, 8e4, 7e4}, Values{3e4, -1e5, -1e5}, Values{1e3, 0, -2e4}}) {
    const auto with = return_map(law(30, 0, 1e3, 1.01 * apex), kElastic, trial);
    const auto without =
        return_map(law(30, 0, 1e3, std::numeric_limits<double>::infinity()), kElastic, trial);
    EXPECT_EQ(with.stress, without.stress);
    EXPECT_EQ(with.region, without.region);
  }
}

TEST(TensionCutoff, AnyReturnIsAdmissibleFinalAndLosesWork) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0, 1);
  std::normal_distribution<double> spread(0, 1);
  int bad = 0, tension = 0;
  for (int i = 0; i < 100000; ++i) {
    const double phi = i % 5 == 0 ? 0 : 45 * part(random), cohesion = 100 + 2e4 * part(random);
    MohrCoulomb m = law(phi, phi * part(random) * (i % 3 > 0), cohesion, 0);
    m.tension = i % 7 == 0 ? 0 : part(random) * std::min(m.apex(), 2 * cohesion);
    const double size = std::pow(10, 2 + 4 * part(random)), mean = size * (2 * part(random) - 1);
    Values trial;
    for (double& s : trial) s = mean + size * spread(random);
    std::sort(trial.begin(), trial.end(), std::greater<>());
    const auto r = return_map(m, kElastic, trial);
    tension += r.region == YieldRegion::tension;
    const double scale = size + std::abs(trial[0]) + std::abs(trial[2]) + cohesion, tolerance = 1e-9 * scale;
    bool good = yield(m, r.stress) <= tolerance && r.stress[0] <= m.tension + tolerance &&
                r.stress[0] >= r.stress[1] - tolerance && r.stress[1] >= r.stress[2] - tolerance;
    Values drop;
    const double volume = r.plastic_strain[0] + r.plastic_strain[1] + r.plastic_strain[2];
    double work = 0;
    for (int a = 0; a < 3; ++a) {
      drop[a] = kElastic.lame() * volume + 2 * kElastic.shear * r.plastic_strain[a];
      good = good && std::abs(trial[a] - drop[a] - r.stress[a]) <= tolerance;
      work += r.stress[a] * r.plastic_strain[a];
    }
    Values again = r.stress;
    std::sort(again.begin(), again.end(), std::greater<>());
    const auto twice = return_map(m, kElastic, again);
    for (int a = 0; a < 3; ++a) good = good && std::abs(twice.stress[a] - again[a]) <= 10 * tolerance;
    good = good && work >= -1e-9 * scale * scale / kElastic.shear;
    bad += !good;
  }
  EXPECT_EQ(bad, 0);
  EXPECT_GT(tension, 20000);
}

TEST(Softening, CohesionFallsLinearlyWithPlasticShearStrain) {
  Soil s = test::sand();
  s.model.friction_angle = 0, s.model.cohesion = 1000;
  s.model.residual_cohesion = 400, s.model.softening_strain = 0.02;
  const SoilMaterial material = SoilMaterial::from(s, {});
  SoilState<2> state;
  Gradient<2> l{};
  l[0][1] = l[1][0] = 0.5;  // simple shear without spin: γ̇ = 1/s
  double gamma = 0;
  for (int i = 0; i < 6000; ++i) {
    const double strength = std::max(1000 - 600 * state.plastic_strain / 0.02, 400.0);
    update_state<2>(material, state, 0.4, l, 1e-5);
    gamma += 1e-5;
    EXPECT_LE(state.stress[3], strength * (1 + 1e-9));
  }
  EXPECT_NEAR(state.stress[3], 400, 1e-6);
  // All strain beyond the elastic τ/G is plastic: √(2/3 e:e) = γp/√3.
  const double shear = std::get<MohrCoulombLaw>(material.law).elastic.shear;
  EXPECT_NEAR(state.plastic_strain, (gamma - 400 / shear) / std::sqrt(3), 1e-9);
}

}  // namespace
}  // namespace quicksand
