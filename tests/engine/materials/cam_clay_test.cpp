// Modified Cam-Clay against its closed forms: lines of the compression plane, critical state, undrained
// strength; and what must hold for any step.

#include "engine/materials/cam_clay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace quicksand {
namespace {

constexpr double kLambda = 0.2, kKappa = 0.04, kM = 1.1, kPorosity = 0.5;

CamClayLaw law(double ocr = 1) {
  SoilModel m;
  m.law = SoilLaw::modified_cam_clay;
  m.poisson_ratio = 0.25;
  m.compression_slope = kLambda, m.swelling_slope = kKappa, m.critical_state_slope = kM;
  m.over_consolidation_ratio = ocr;
  return CamClayLaw::from(m);
}

SoilState<3> isotropic(const CamClayLaw& clay, double p) {
  SoilState<3> s;
  s.stress = {-p, -p, -p, 0, 0, 0};
  EXPECT_EQ(clay.begin(s), 0);
  return s;
}

double pressure(const SoilState<3>& s) { return -trace(s.stress) / 3; }
double deviatoric(const SoilState<3>& s) { return std::sqrt(1.5 * contracted(deviator(s.stress))); }
double yield(const SoilState<3>& s) {
  const double p = pressure(s), q = deviatoric(s);
  return q * q / (kM * kM) + p * (p - s.preconsolidation);
}

/// Strains the state and follows the porosity as the engine does.
int strain(const CamClayLaw& clay, SoilState<3>& s, double& n, const Strain<3>& e) {
  const int held = clay.update(s, e, n);
  n = 1 - (1 - n) / (1 + trace(e));
  return held;
}
double void_ratio(double n) { return n / (1 - n); }

TEST(CamClay, IsotropicCompressionAndSwellingAreTheLinesOfTheCompressionPlane) {
  const CamClayLaw clay = law();
  SoilState<3> s = isotropic(clay, 1e5);
  double n = kPorosity;
  const double e0 = void_ratio(n);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(strain(clay, s, n, {-2e-3, -2e-3, -2e-3, 0, 0, 0}), 0);
  const double p = pressure(s), e = void_ratio(n);
  EXPECT_NEAR(std::log(p / 1e5) * kLambda / (e0 - e), 1, 1e-10);
  EXPECT_NEAR(s.preconsolidation / p, 1, 1e-10);
  for (int i = 0; i < 10; ++i) strain(clay, s, n, {1e-3, 1e-3, 1e-3, 0, 0, 0});
  EXPECT_NEAR(std::log(p / pressure(s)) * kKappa / (void_ratio(n) - e), 1, 1e-10);
  EXPECT_NEAR(s.preconsolidation / p, 1, 1e-10);
}

TEST(CamClay, UndrainedShearEndsAtTheCriticalState) {
  // p at critical state: p0 (OCR/2)^(1 − κ/λ), q = M p; light and heavy overconsolidation.
  for (const double ocr : {1.0, 1.5, 4.0, 10.0}) {
    const CamClayLaw clay = law(ocr);
    SoilState<3> s = isotropic(clay, 1e5);
    double n = kPorosity;
    for (int i = 0; i < 20000; ++i) strain(clay, s, n, {5e-5, 5e-5, -1e-4, 0, 0, 0});
    const double expected = 1e5 * std::pow(ocr / 2, 1 - kKappa / kLambda);
    EXPECT_NEAR(pressure(s) / expected, 1, 1e-3) << ocr;
    EXPECT_NEAR(deviatoric(s) / (kM * pressure(s)), 1, 1e-4) << ocr;
    EXPECT_NEAR(n, kPorosity, 1e-12);
  }
}

TEST(CamClay, AnyStepEndsWithinTheYieldSurfaceWithAssociatedFlow) {
  std::mt19937 random(3);
  std::normal_distribution<double> spread(0, 1);
  std::uniform_real_distribution<double> part(0, 1);
  int yielded = 0, bad = 0;
  for (int i = 0; i < 20000; ++i) {
    const CamClayLaw clay = law(1 + 5 * part(random));
    SoilState<3> s;
    const double p0 = std::pow(10, 3 + 3 * part(random));
    for (int k = 0; k < 6; ++k) s.stress[k] = (k < 3 ? -p0 : 0) + 0.3 * p0 * part(random) * spread(random);
    if (pressure(s) < 100) continue;
    clay.begin(s);
    const double pc = s.preconsolidation;
    Strain<3> e;
    const double size = std::pow(10, -5 + 4 * part(random));
    for (double& c : e) c = size * spread(random);
    SoilState<3> next = s;
    if (clay.update(next, e, kPorosity)) continue;
    const double scale = next.preconsolidation * (pressure(next) + next.preconsolidation);
    bool good = yield(next) <= 1e-10 * scale && pressure(next) > 0;
    if (next.plastic_strain > 0) {
      ++yielded;
      good = good && std::abs(yield(next)) <= 1e-10 * scale;
      // Associated: plastic shear over plastic volume is 2q / M²(2p − pc); volume from the hardening.
      const double volumetric = (kLambda - kKappa) * (1 - kPorosity) * std::log(next.preconsolidation / pc);
      const double direction =
          2 * deviatoric(next) / (kM * kM * (2 * pressure(next) - next.preconsolidation));
      good = good &&
             std::abs(next.plastic_strain - direction * volumetric) <= 1e-6 * next.plastic_strain + 1e-13;
      const double elastic = kKappa * (1 - kPorosity) * std::log(pressure(next) / pressure(s));
      good = good && std::abs(-trace(e) - volumetric - elastic) < 1e-9 * size;
    }
    bad += !good;
  }
  EXPECT_EQ(bad, 0);
  EXPECT_GT(yielded, 3000);
}

TEST(CamClay, TheLeastPressureIsHeldAndCounted) {
  const CamClayLaw clay = law();
  SoilState<3> s;  // no stress at all
  EXPECT_EQ(clay.begin(s), 1);
  EXPECT_EQ(pressure(s), CamClayLaw{}.least_pressure);
  double n = kPorosity;
  EXPECT_EQ(strain(clay, s, n, {0.1, 0.1, 0.1, 0, 0, 0}), 1);
  EXPECT_EQ(pressure(s), CamClayLaw{}.least_pressure);
  EXPECT_LE(yield(s), 1e-9);
  for (int i = 0; i < 1000; ++i) strain(clay, s, n, {-1e-3, -1e-3, -1e-3, 0, 0, 0});
  EXPECT_GT(pressure(s), 100);  // stiffens again
  EXPECT_GT(clay.constrained_modulus(s, n), clay.constrained_modulus(SoilState<3>{}, n));
}

TEST(CamClay, StiffnessAndEnergyFollowThePressure) {
  const CamClayLaw clay = law(10);
  SoilState<3> s = isotropic(clay, 1e5);
  const double bulk = 1e5 / (0.5 * kKappa);
  EXPECT_NEAR(clay.bulk(1e5, kPorosity), bulk, 1e-6);
  const double shear = bulk * 3 * 0.5 / (2 * 1.25);
  EXPECT_NEAR(clay.constrained_modulus(s, kPorosity), bulk + 4 * shear / 3, 1e-6);
  // Work of an isotropic compression within the surface is the growth of the energy.
  double n = kPorosity, work = 0;
  const double before = clay.energy(s, n) / (1 - n);
  for (int i = 0; i < 1000; ++i) {
    const double p = pressure(s), volume = 1 / (1 - n);
    strain(clay, s, n, {-1e-5, -1e-5, -1e-5, 0, 0, 0});
    work += 0.5 * (p + pressure(s)) * (volume - 1 / (1 - n));
  }
  EXPECT_EQ(s.plastic_strain, 0);
  EXPECT_NEAR((clay.energy(s, n) / (1 - n) - before) / work, 1, 1e-5);
}

}  // namespace
}  // namespace quicksand
