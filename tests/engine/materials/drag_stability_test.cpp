#include <gtest/gtest.h>

#include <cmath>

#include "engine/materials/stability.hpp"
#include "tests/engine/small_scene.hpp"

namespace quicksand {
namespace {

constexpr double kGravity = 9.81;  // m/s², of the definition of hydraulic conductivity

TEST(Drag, DarcyWithConstantPermeability) {
  Soil soil = test::sand();
  soil.permeability.law = PermeabilityLaw::constant;
  const Drag drag = Drag::from(soil, {});
  EXPECT_NEAR(drag.resistance(0.4), 0.16 * 1000 * kGravity / 1e-4, 1e-3);
  EXPECT_NEAR(drag.resistance(0.5), 0.25 * 1000 * kGravity / 1e-4, 1e-3);  // n² ρw g / k
}

TEST(Drag, KozenyCarmanFollowsThePorosity) {
  const Soil soil = test::sand();
  const Drag drag = Drag::from(soil, {});
  const auto shape = [](double n) { return n * n * n / ((1 - n) * (1 - n)); };
  EXPECT_NEAR(drag.resistance(0.4), 0.16 * 1000 * kGravity / 1e-4, 1e-3);
  for (const double n : {0.2, 0.35, 0.6, 0.9}) {
    const double k = 1e-4 * shape(n) / shape(0.4), expected = n * n * 1000 * kGravity / k;
    EXPECT_NEAR(drag.resistance(n) / expected, 1, 1e-12) << n;
  }
  EXPECT_LT(drag.resistance(0.9), drag.resistance(0.4));  // loosened soil lets water through
}

TEST(Drag, PowerOfTheVolume) {
  Soil soil = test::sand();
  soil.permeability.law = PermeabilityLaw::power;
  soil.permeability.exponent = 3;
  const Drag drag = Drag::from(soil, {});
  for (const double n : {0.2, 0.4, 0.6}) {
    const double k = 1e-4 * std::pow(0.6 / (1 - n), 3);  // (1+e)/(1+e0) = (1−n0)/(1−n)
    EXPECT_NEAR(drag.resistance(n) * k / (n * n * 1000 * kGravity), 1, 1e-12) << n;
  }
}

TEST(Drag, ErgunsPressureDrop) {
  Soil soil = test::sand();
  soil.permeability = {.law = PermeabilityLaw::ergun, .grain_size = 5e-4};
  const Drag drag = Drag::from(soil, {});
  EXPECT_TRUE(drag.follows_speed());
  // Minimum fluidization of references.json: the drop carries the submerged grains at 2.801 mm/s.
  const double n = 0.4, q = 2.801e-3, drop = drag.resistivity(n, q) * q;
  EXPECT_NEAR(drop / ((1 - n) * (2650 - 1000) * kGravity), 1, 1e-3);
  // On the grains, per volume and relative velocity w = q/n: the drop's share R w = n ∇p.
  EXPECT_NEAR(drag.resistance(n, q) * q / n, n * drop, 1e-9 * drop);
  const double viscous = 150 * 1e-3 * 0.36 / (0.064 * 25e-8), inertial = 1.75 * 1000 * 0.6 / (0.064 * 5e-4);
  EXPECT_NEAR(drag.resistivity(n), viscous, 1e-9 * viscous);
  EXPECT_NEAR(drag.resistivity(n, 1) - viscous, inertial, 1e-9 * inertial);
}

TEST(Drag, FollowsTheDensityOfTheWater) {
  Water oil;
  oil.density = 800;
  EXPECT_NEAR(Drag::from(test::sand(), oil).resistance(0.4) / Drag::from(test::sand(), {}).resistance(0.4),
              0.8, 1e-12);
}

const double kConstrained = Elastic::from_young(1e7, 0.3).constrained();  // Pa, 13.5 MPa

/// Soil of E = 10 MPa, ν = 0.3, n = 0.4 in nearly incompressible water.
SaturatedSoil reference(double permeability) {
  return {kConstrained, 2650, 1000, 1 / 2.2e9, 0.4, 0.16 * 1000 * kGravity / permeability};
}
constexpr double kCell = 0.01;  // m

TEST(Stability, DryLimitIsTheFramesWaveAcrossACell) {
  const SaturatedSoil soil = reference(1e-4);
  EXPECT_NEAR(dry_step_limit(soil, kCell), 0.01 * std::sqrt(0.6 * 2650 / kConstrained), 1e-15);
  EXPECT_NEAR(dry_step_limit(soil, 10 * kCell) / dry_step_limit(soil, kCell), 10, 1e-12);
}

TEST(Stability, SurfaceLimitSolvesItsQuadratic) {
  for (const double k : {1e-2, 1e-4, 1e-6}) {
    const SaturatedSoil soil = reference(k);
    const double dt = surface_step_limit(soil, kCell), mass = 0.6 * 2650;
    const double wave = 4 * dt * dt * kConstrained / (mass * kCell * kCell),
                 damping = 4 + 2 * dt * soil.drag / mass;
    EXPECT_NEAR(wave / damping, 1, 1e-12);
  }
  SaturatedSoil free = reference(1);
  free.drag = 0;
  EXPECT_NEAR(surface_step_limit(free, kCell), dry_step_limit(free, kCell), 1e-15);
}

// Figures of the prototype's von Neumann analysis, to two digits.
TEST(Stability, CoupledLimitHasTheReferenceValues) {
  const std::pair<double, double> expected[] = {{1e-2, 1.4e-4}, {1e-4, 4e-4}, {1e-6, 3.6e-2}};
  for (const auto& [k, seconds] : expected)
    EXPECT_NEAR(coupled_step_limit(reference(k), kCell) / seconds, 1, 0.1) << k;
}

TEST(Stability, StifferOrLooserSoilNeedsSmallerSteps) {
  SaturatedSoil soil = reference(1e-4);
  const double bound = coupled_step_limit(soil, kCell);
  soil.constrained_modulus *= 4;
  EXPECT_LT(coupled_step_limit(soil, kCell), 0.75 * bound);
  soil = reference(1e-3);
  EXPECT_LT(coupled_step_limit(soil, kCell), bound);
  EXPECT_LT(surface_step_limit(soil, kCell), surface_step_limit(reference(1e-4), kCell));
}

/// h/c of the characteristic polynomial c⁴ Ms Mw − c² (…) + det K, written out.
TEST(Stability, FastWaveSolvesItsCharacteristicPolynomial) {
  for (const double n : {0.05, 0.4, 0.9}) {
    SaturatedSoil soil = reference(1e-4);
    soil.porosity = n;
    soil.water_compliance = 1 / 2e7;
    const double c = kCell / fast_wave_step_limit(soil, kCell), q = 2e7 / n, phi = 1 - n;
    const double ms = phi * 2650, mw = n * 1000, k11 = kConstrained + q * phi * phi, k22 = q * n * n;
    const double k12 = q * n * phi;
    const double determinant = (k11 - c * c * ms) * (k22 - c * c * mw) - k12 * k12;
    EXPECT_LT(std::abs(determinant), 1e-9 * k11 * k22);
    EXPECT_GT(c * c, k11 / ms);  // the larger root: above either phase alone
    EXPECT_GT(c * c, k22 / mw);
    EXPECT_GE(c, std::sqrt((kConstrained + q) / (ms + mw)));  // and no slower than the undrained wave
  }
}

/// Grains and water may swing together across a wave, which tight soil does not hinder.
TEST(StepLimit, TightSoilIsBoundByItsShearWaves) {
  Soil s = test::sand();
  s.permeability.value = 1e-8;
  const SoilMaterial material = SoilMaterial::from(s, {});
  const double modulus = material.constrained_modulus<2>({}, 0.4), nu = s.model.poisson_ratio;
  const double shear = modulus * (1 - 2 * nu) / (2 - 2 * nu);
  EXPECT_NEAR(StepLimit(material, 1000, 1 / 2.2e9, kCell).saturated(0.4, modulus) /
                  (kCell * std::sqrt(0.6 * s.grain_density / shear)),
              1, 1e-3);
}

TEST(StepLimit, TableAgreesWithTheAnalysis) {
  const Soil s = test::sand();
  const SoilMaterial material = SoilMaterial::from(s, {});
  const double modulus = material.constrained_modulus<2>({}, 0.4);
  const StepLimit limit(material, 1000, 1 / 2.2e9, kCell);
  for (const double n : {0.25, 0.4, 0.41, 0.55}) {
    const SaturatedSoil soil{
        modulus, 2650, 1000, 1 / 2.2e9, n, material.drag.resistance(n), modulus * material.shear_share};
    const double saturated = std::min(
        {coupled_step_limit(soil, kCell), surface_step_limit(soil, kCell), shear_step_limit(soil, kCell)});
    EXPECT_NEAR(limit.dry(n, modulus) / dry_step_limit(soil, kCell), 1, 1e-3) << n;
    EXPECT_NEAR(limit.saturated(n, modulus) / saturated, 1, 0.02) << n;
    EXPECT_NEAR(limit.fast_wave(n, modulus) / fast_wave_step_limit(soil, kCell), 1, 1e-3) << n;
  }
  for (const double n : {0.0, 0.02, 0.999, 1.0}) {  // any porosity that a point may have
    EXPECT_GT(limit.dry(n, modulus), 0);
    EXPECT_GT(limit.saturated(n, modulus), 0);
  }
}

/// Of a range of porosities it is the smallest bound of any of them, to the distance of the samples.
TEST(StepLimit, LeastOfARangeIsTheSmallestInIt) {
  const SoilMaterial material = SoilMaterial::from(test::sand(), {});
  const double modulus = material.constrained_modulus<2>({}, 0.4);
  const StepLimit limit(material, 1000, 1 / 2.2e9, kCell);
  for (const StepLimit::Range range :
       {StepLimit::Range{0.4, 0.4}, {0.39, 0.402}, {0.0, 1.0}, {0.31, 0.77}, {0.995, 1}}) {
    double dry = 1e99, saturated = 1e99, fast_wave = 1e99;
    for (int i = 0; i <= 10000; ++i) {
      const double n = range.low + (range.high - range.low) * i / 10000;
      dry = std::min(dry, limit.dry(n, modulus));
      saturated = std::min(saturated, limit.saturated(n, modulus));
      fast_wave = std::min(fast_wave, limit.fast_wave(n, modulus));
    }
    EXPECT_NEAR(limit.least_dry(range) / dry, 1, 1e-3) << range.low;
    EXPECT_NEAR(limit.least_saturated(range) / saturated, 1, 1e-3) << range.low;
    EXPECT_NEAR(limit.least_fast_wave(range) / fast_wave, 1, 1e-3) << range.low;
    EXPECT_LE(limit.least_saturated(range), saturated * (1 + 1e-12)) << range.low;
  }
  EXPECT_TRUE(std::isinf(limit.least_dry({})));
}

}  // namespace
}  // namespace quicksand
