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

constexpr double kPondWidth = 0.4;

/// A saturated bed under 0.2 m of free water, with a plate on it.
Scene under_a_pond(double from, double to, double duration) {
  Scene s = pressed_block(BodyKind::saturated_soil, duration);
  s.gravity = {0, -9.81, 0};
  s.domain.max = {kPondWidth, 0.7, 0};
  s.bodies[0].region.max = {kPondWidth, kHeight, 0};
  add_body(s, "pond", BodyKind::water, {0, kHeight, 0}, {kPondWidth, 0.6, 0});
  s.soils["sand"].permeability = {.law = PermeabilityLaw::constant, .value = 1e-4};
  s.initial.stress = InitialStress::k0;
  s.initial.pressure = InitialPressure::hydrostatic;
  s.loads[0].plate = {{from, kHeight, 0}, {to, kHeight, 0}};
  s.output.probes = {{"below", {0.2, 0.375, 0}, "pore_pressure"},
                     {"above", {0.2, 0.425, 0}, "pore_pressure"}};
  return s;
}

/// Water does not pass it, nor its pressure: below it the load comes on top of the pond's, above it nothing.
TEST(Plates, APlateUnderWaterPartsThePressures) {
  for (const double load : {1e-3, 2e3}) {
    Scene s = under_a_pond(0, kPondWidth, 0.1);
    s.loads[0].plate_force = Vec3{0, -load, 0};
    const Recorded r = record(s);
    ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
    const double water = 2.2e9 / 0.4, carried = load / kPondWidth * water / (water + kYoung);
    EXPECT_NEAR(late_mean(r.results.series("probe.below")), 9810 * 0.225 + carried, 0.005 * 9810 * 0.225);
    EXPECT_NEAR(late_mean(r.results.series("probe.above")), 9810 * 0.175, 1e-3 * 9810 * 0.175);
    EXPECT_LT(r.results.last("max_speed"), 1e-5);
    EXPECT_LT(r.report.ledger.momentum_residual, 1e-10);
  }
}

/// It lies on the bed beside open bed: everything stays at rest, until the load presses water out sideways.
TEST(Plates, APlateOnPartOfAWetBedRests) {
  for (const double load : {1e-3, 2e2}) {
    Scene s = under_a_pond(0, kPondWidth / 2, 1);
    s.loads[0].plate_force = Vec3{0, -load, 0};
    const Recorded r = record(s);
    ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
    const double moved = r.results.last("plate.plate.movement");
    if (load < 1) {
      EXPECT_NEAR(moved, 0, 1e-6);
      EXPECT_LT(r.results.last("max_speed"), 1e-5);
    } else {  // at most as if the bed could not spread the load
      EXPECT_LT(moved, -1e-5);
      EXPECT_GT(moved, -load / (kPondWidth / 2) * kHeight / kYoung);
    }
    EXPECT_NEAR(late_mean(r.results.series("probe.above")), 9810 * 0.175, 1e-3 * 9810 * 0.175);
    EXPECT_LT(r.report.ledger.momentum_residual, 1e-10);
  }
}

constexpr double kLayer = 0.1, kLength = 1, kPressed = 1e4, kSheared = 1e-5;

/// A layer that sticks to its base, with free ends, under a plate along it that goes sideways. It begins
/// pressed, so that the plate touches.
Scene sheared_layer(bool rough) {
  Scene s = pressed_block(BodyKind::soil, 0.2);
  s.domain.max = {kLength + 0.2, 0.2, 0};
  s.domain.cell_size = 0.025;
  s.domain.sides[2].kind = SideKind::no_slip;
  s.bodies[0].region = box({0.1, 0, 0}, {kLength + 0.1, kLayer, 0});
  s.initial.stress = InitialStress::uniform;
  s.initial.uniform_stress = {0, -kPressed, 0, 0, 0, 0};
  s.loads[0].plate = {{0.1, kLayer, 0}, {kLength + 0.1, kLayer, 0}};
  s.loads[0].plate_velocity = {kSheared / 0.15, 0, 0};  // half of 0.1 s at half the speed, 0.1 s at the whole
  s.loads[0].rough = rough;
  return s;
}

/// Largest relative error of displacement and stress in the middle, against simple shear: τ = G u/H, the
/// displacement linear in height.
double from_simple_shear(const Recorded& r) {
  const Frame& last = r.results.frames.back();
  const auto &u = field(last, "displacement"), &stress = field(last, "effective_stress");
  double error = 0;
  for (std::size_t p = 0; p < last.points(); ++p) {
    const double x = last.position[3 * p] - 0.1, y = last.position[3 * p + 1];
    if (std::abs(x - kLength / 2) > kLayer) continue;
    error = std::max(error, std::abs(u[3 * p] / (kSheared * y / kLayer) - 1));
    error = std::max(error, std::abs(stress[4 * p + 3] / (kYoung / 2 * kSheared / kLayer) - 1));
  }
  return error;
}

TEST(Plates, ARoughPlateShearsTheSoilBelow) {
  const Recorded r = record(sheared_layer(true));
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  EXPECT_LT(from_simple_shear(r), 0.005);
  EXPECT_LT(r.report.ledger.momentum_residual, 1e-10);
}

TEST(Plates, ASmoothPlateSlides) {
  const Recorded r = record(sheared_layer(false));
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  EXPECT_NEAR(from_simple_shear(r), 1, 0.01);  // nothing moves
}

/// Free to spread sideways in plane strain: σ = E/(1−ν²) ε under a smooth plate, more under a rough one,
/// whose edge holds the soil.
TEST(Plates, OnlyASmoothPlateLetsTheSoilSpread) {
  double spread[2], force[2];
  for (const bool rough : {false, true}) {
    Scene s = pressed_block(BodyKind::soil, 0.4);
    s.domain.max[0] = 2 * kWidth;
    s.domain.sides[0].kind = SideKind::symmetry;
    s.soils["sand"].model.poisson_ratio = 0.3;
    s.loads[0].plate_velocity = {0, -1e-3, 0};
    s.loads[0].rough = rough;
    const Recorded r = record(s);
    ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
    EXPECT_LT(r.report.ledger.momentum_residual, 1e-10);
    const auto movement = r.results.series("plate.plate.movement"),
               pushed = r.results.series("plate.plate.force");
    force[rough] = spread[rough] = 0;
    for (std::size_t i = 50; i < pushed.size(); ++i) force[rough] += pushed[i] / movement[i] / 51;
    const Frame& last = r.results.frames.back();
    for (std::size_t p = 0; p < last.points(); ++p)
      if (last.position[3 * p + 1] > kHeight - 0.025)
        spread[rough] = std::max<double>(spread[rough], field(last, "displacement")[3 * p]);
  }
  constexpr double kOutermost = kWidth - 0.05 / 4;  // two points per cell and axis
  const double stiffness = kYoung / (1 - 0.09) * kWidth / kHeight,
               free = 0.3 / 0.7 * 3e-4 / kHeight * kOutermost;
  EXPECT_NEAR(force[0], stiffness, 0.01 * stiffness);
  EXPECT_GT(force[1], 1.02 * force[0]);
  EXPECT_NEAR(spread[0], free, 0.02 * free);
  EXPECT_LT(spread[1], 0.3 * free);
}

}  // namespace
}  // namespace quicksand::test
