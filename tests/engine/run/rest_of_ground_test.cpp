// Ground that is loaded by its weight comes to rest with the stress of its weight, and damping brings it
// there.

#include <gtest/gtest.h>

#include "tests/engine/small_scene.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand::test {
namespace {

constexpr double kHeight = 0.8, kPond = 1, kRatio = 0.3, kWaterWeight = 9810;

/// An elastic layer without stress or pressure, under a pond if it is saturated.
Scene weightless_layer(BodyKind kind, double permeability, double damping) {
  Scene s = plane(0.08, 1.2, 0.04, 8);
  add_body(s, "layer", kind, {0, 0, 0}, {0.08, kHeight, 0});
  s.soils["sand"].permeability.value = permeability;
  s.soils["sand"].model = {.law = SoilLaw::linear_elastic, .young_modulus = 1e7, .poisson_ratio = kRatio};
  if (kind == BodyKind::saturated_soil)
    add_body(s, "pond", BodyKind::water, {0, kHeight, 0}, {0.08, kPond, 0});
  s.initial.stress = InitialStress::zero;
  s.initial.pressure = InitialPressure::zero;
  s.stages[0].damping = damping;
  s.stages[0].until_rest = UntilRest{1e-5, 0};
  s.output.frame_interval = 8;
  return s;
}

void expect_stress_of_weight(const Recorded& r, double weight) {
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const Frame& last = r.results.frames.back();
  const auto &stress = field(last, "effective_stress"), &pressure = field(last, "pore_pressure"),
             &moved = field(last, "displacement");
  const double all = weight * kHeight, k0 = kRatio / (1 - kRatio);
  for (std::size_t p = 0; p < last.points(); ++p) {
    if (last.phase[p] == 1) {
      const double depth = kPond - last.position[3 * p + 1];
      EXPECT_NEAR(pressure[p], kWaterWeight * depth, 0.005 * kWaterWeight * kPond);
      continue;
    }
    const double vertical = weight * (kHeight - last.position[3 * p + 1] + moved[3 * p + 1]);
    EXPECT_NEAR(-stress[4 * p + 1], vertical, 0.01 * all);
    EXPECT_NEAR(-stress[4 * p], k0 * vertical, 0.01 * k0 * all);
    EXPECT_NEAR(-stress[4 * p + 2], k0 * vertical, 0.01 * k0 * all);
    EXPECT_NEAR(stress[4 * p + 3], 0, 0.001 * all);
  }
  EXPECT_LT(r.report.ledger.momentum_residual, 1e-10);
}

TEST(RestOfGround, DryLayerIsThereSoonWithDamping) {
  const Recorded damped = record(weightless_layer(BodyKind::soil, 1e-4, 0.7));
  expect_stress_of_weight(damped, 0.6 * 2650 * 9.81);
  EXPECT_LT(damped.report.sim_time, 1);
  const Recorded free = record(weightless_layer(BodyKind::soil, 1e-4, 0));
  EXPECT_GT(free.report.sim_time, 8 - 1e-9);  // not at rest by then
  // Of the work of weight one half is in the strain, the other was taken.
  const Ledger& l = damped.report.ledger;
  EXPECT_NEAR(l.energy_damped, l.energy_strain, 0.1 * l.energy_strain);
}

/// Gravel, so permeable that the water does not damp by itself.
TEST(RestOfGround, SaturatedGravelIsThereSoonWithDamping) {
  const Recorded damped = record(weightless_layer(BodyKind::saturated_soil, 0.3, 0.7));
  expect_stress_of_weight(damped, 0.6 * 1650 * 9.81);
  EXPECT_LT(damped.report.sim_time, 1);
  const Recorded free = record(weightless_layer(BodyKind::saturated_soil, 0.3, 0));
  EXPECT_GT(free.report.steps, 2 * damped.report.steps);
}

/// In sand the drag of the water does it; damping must not hinder.
TEST(RestOfGround, SaturatedSandIsThereAsSoon) {
  const Recorded damped = record(weightless_layer(BodyKind::saturated_soil, 3e-3, 0.7));
  expect_stress_of_weight(damped, 0.6 * 1650 * 9.81);
  const Recorded free = record(weightless_layer(BodyKind::saturated_soil, 3e-3, 0));
  EXPECT_NEAR(damped.report.sim_time, free.report.sim_time, 0.1 * free.report.sim_time);
}

TEST(RestOfGround, ThreadsNeverChangeTheDampedResult) {
  Scene s = plane(1, 0.8, 0.05, 0.02);
  add_body(s, "bank", BodyKind::saturated_soil, {0, 0, 0}, {0.4, 0.4, 0});
  add_body(s, "pool", BodyKind::water, {0.4, 0, 0}, {0.7, 0.6, 0});
  s.stages[0].damping = 0.5;
  const Recorded one = record(s, 1), two = record(s, 2);
  EXPECT_EQ(one.results.frames.back().position, two.results.frames.back().position);
  EXPECT_EQ(one.results.series("ledger.energy_damped"), two.results.series("ledger.energy_damped"));
}

}  // namespace
}  // namespace quicksand::test
