// Rigid plates: stiffness under force and velocity, undrained water below, momentum, what is not pulled.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/small_scene.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand::test {
namespace {

constexpr double kYoung = 1e7, kHeight = 0.4, kWidth = 0.2;

/// An elastic block (ν = 0) between smooth walls under a plate that acts in full after half the run.
Scene pressed_block(BodyKind kind, double duration) {
  Scene s = plane(kWidth, 0.5, 0.05, duration);
  s.gravity = {0, 0, 0};
  add_body(s, "block", kind, {0, 0, 0}, {kWidth, kHeight, 0});
  s.soils["sand"].model = {.law = SoilLaw::linear_elastic, .young_modulus = kYoung};
  s.initial.stress = InitialStress::zero;
  s.initial.pressure = InitialPressure::zero;
  Load load;
  load.kind = Load::Kind::plate;
  load.name = "plate";
  load.body = "block";
  load.plate = {{0, kHeight, 0}, {kWidth, kHeight, 0}};
  load.ramp = duration / 2;
  s.loads = {load};
  s.output.frame_interval = duration;
  s.output.series_interval = duration / 100;
  return s;
}

double late_mean(const std::vector<double>& v) {
  double sum = 0;
  for (std::size_t i = v.size() * 3 / 4; i < v.size(); ++i) sum += v[i];
  return sum / static_cast<double>(v.size() - v.size() * 3 / 4);
}

TEST(Plates, AForceSettlesTheBlockByItsStiffness) {
  Scene s = pressed_block(BodyKind::soil, 0.4);
  s.loads[0].plate_force = Vec3{0, -2e3, 0};
  const Recorded r = record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const double expected = -2e3 / kWidth / kYoung * kHeight;
  EXPECT_NEAR(late_mean(r.results.series("plate.plate.movement")), expected, 0.02 * -expected);
  EXPECT_LT(r.report.ledger.momentum_residual, 1e-10);
}

TEST(Plates, AVelocityMeetsTheBlocksResistance) {
  Scene s = pressed_block(BodyKind::soil, 0.4);
  s.loads[0].plate_velocity = {0, -1e-3, 0};
  const Recorded r = record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const auto movement = r.results.series("plate.plate.movement"),
             force = r.results.series("plate.plate.force");
  EXPECT_NEAR(movement.back(), -3e-4, 5e-6);  // half the speed while it rises
  double stiffness = 0;
  for (std::size_t i = 50; i < force.size(); ++i) stiffness += force[i] / movement[i] / 51;
  EXPECT_NEAR(stiffness, kYoung * kWidth / kHeight, 0.03 * kYoung * kWidth / kHeight);
  EXPECT_LT(r.report.ledger.momentum_residual, 1e-10);
}

/// Water cannot leave: it carries (Kw/n) / (Kw/n + Ec) of the load at once.
TEST(Plates, WaterUnderAPlateCarriesTheLoad) {
  Scene s = pressed_block(BodyKind::saturated_soil, 0.05);
  s.soils["sand"].permeability = {.law = PermeabilityLaw::constant, .value = 1e-5};
  s.loads[0].plate_force = Vec3{0, -2e3, 0};
  s.output.probes = {{"middle", {0.1, 0.2, 0}, "pore_pressure"}};
  const Recorded r = record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const double water = 2.2e9 / 0.4, expected = 2e3 / kWidth * water / (water + kYoung);
  EXPECT_NEAR(late_mean(r.results.series("probe.middle")), expected, 0.02 * expected);
}

TEST(Plates, ALiftedPlateLetsGo) {
  Scene s = pressed_block(BodyKind::soil, 0.1);
  s.loads[0].plate_velocity = {0, 1e-2, 0};
  const Recorded r = record(s);
  EXPECT_EQ(r.report.status, RunStatus::succeeded);
  for (const double f : r.results.series("plate.plate.force")) EXPECT_LE(f, 0);
  EXPECT_LT(r.results.last("body.block.largest_displacement"), 1e-6);
  EXPECT_NEAR(r.results.last("plate.plate.movement"), 7.5e-4, 1e-5);
}

}  // namespace
}  // namespace quicksand::test
