// A million steps: what drifts slowly shows. Scenes of some hundred points, half a minute each.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "tests/engine/small_scene.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand::test {
namespace {

constexpr long kSteps = 1'000'000;
constexpr double kDrift = 0.002, kEdge = 0.05;  // –; m, of a cell
constexpr double kGamma = 9810;                 // N/m³

Scene long_scene(int wide, int high, double step) {
  Scene s = plane(wide * kEdge, high * kEdge, kEdge, step * static_cast<double>(kSteps));
  s.numerics.time_step = step;
  s.output.frame_interval = s.stages[0].duration;
  s.output.series_interval = s.stages[0].duration / 1000;
  s.output.fields = {"velocity"};
  return s;
}

/// Ran to its end, kept its volume, and came to rest without ever gaining energy again. `given`: J, what
/// loads did; `moved`: J, what was set free or given, by which the rest is measured.
Recorded settled(const Scene& s, double given, double moved) {
  Recorded r = record(s, 1);
  EXPECT_EQ(r.report.status, RunStatus::succeeded);
  EXPECT_GE(r.report.steps, kSteps);
  EXPECT_EQ(r.report.ledger.retries, 0);
  EXPECT_LE(r.report.ledger.water_volume_drift_max, kDrift);
  const auto energy = r.results.series("ledger.energy"), kinetic = r.results.series("ledger.energy_kinetic");
  const std::size_t first = energy.size() / 4;  // the column consolidates for eight of its time constants
  const auto at_most = [&](std::size_t from, const std::vector<double>& values) {
    return *std::max_element(values.begin() + static_cast<std::ptrdiff_t>(from), values.end());
  };
  EXPECT_LE(at_most(0, energy), energy.front() + given);
  EXPECT_LE(at_most(first, kinetic), 1e-6 * moved);
  EXPECT_LE(at_most(first, energy), energy.back() + 1e-3 * moved);
  EXPECT_GE(*std::min_element(energy.begin() + static_cast<std::ptrdiff_t>(first), energy.end()),
            energy.back() - 1e-3 * moved);
  std::cout << "drift at most " << r.report.ledger.water_volume_drift_max << ", at rest "
            << r.report.ledger.water_volume_drift << "; energy above the start "
            << at_most(0, energy) - energy.front() << " of " << given << " J, kinetic at the end "
            << kinetic.back() << " J\n";
  return r;
}

/// Weight × height of the middle of mass, within what twice the drift of a level does.
void expect_potential(const Recorded& r, double joules) {
  EXPECT_NEAR(r.results.last("ledger.energy_potential"), joules, 2 * kDrift * joules);
}

TEST(SlowLongRun, ATiltedPoolComesToRestAtItsLevel) {
  Scene s = long_scene(8, 6, 0.002);
  Body body;
  body.name = "pool", body.kind = BodyKind::water;
  body.region.kind = Region::Kind::polygon;
  body.region.vertices = {{0, 0}, {0.4, 0}, {0.4, 0.175}, {0, 0.225}};
  s.bodies = {body};
  expect_potential(settled(s, 0, 0.5), 0.5 * kGamma * 0.4 * 0.2 * 0.2);
}

TEST(SlowLongRun, AClosedTankWithoutASurfaceStays) {
  Scene s = long_scene(6, 4, 0.01);
  add_body(s, "water", BodyKind::water, {0, 0, 0}, {0.3, 0.2, 0});
  s.bodies[0].velocity = {0.1, 0, 0};
  expect_potential(settled(s, 0, 0.3), 0.5 * kGamma * 0.3 * 0.2 * 0.2);
}

TEST(SlowLongRun, AUTubeComesToRestAtItsLevel) {
  Scene s = long_scene(8, 6, 0.002);
  add_body(s, "left", BodyKind::water, {0, 0, 0}, {0.1, 0.2, 0});
  add_body(s, "floor", BodyKind::water, {0.1, 0, 0}, {0.3, 0.1, 0});
  add_body(s, "right", BodyKind::water, {0.3, 0, 0}, {0.4, 0.15, 0});
  s.walls.push_back({"core", box({0.1, 0.1, 0}, {0.3, 0.3, 0}), {}, false});
  const double legs = 0.5 * 0.2 * (0.175 * 0.175 - 0.1 * 0.1), below = 0.5 * 0.4 * 0.1 * 0.1;
  expect_potential(settled(s, 0, 0.6), kGamma * (legs + below));
}

TEST(SlowLongRun, AConsolidatedColumnStays) {
  Scene s = long_scene(1, 10, 2e-4);
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {kEdge, 0.4, 0});
  s.soils["sand"].model = {.law = SoilLaw::linear_elastic, .young_modulus = 1e6, .poisson_ratio = 0.2};
  Load load;
  load.name = "load", load.body = "bed", load.traction = {0, -1000, 0}, load.ramp = 0.1;
  s.loads = {load};
  const double modulus = 1e6 * 0.8 / (1.2 * 0.6), settlement = 1000 * 0.4 / modulus;
  const double work = 1000 * kEdge * settlement;
  const Recorded r = settled(s, work, work);
  const auto rise = r.results.series("body.bed.rise");
  EXPECT_NEAR(rise.back(), -0.5 * settlement, 0.02 * settlement);
  EXPECT_NEAR(rise.back(), rise[rise.size() / 2], 1e-4 * settlement);
}

}  // namespace
}  // namespace quicksand::test
