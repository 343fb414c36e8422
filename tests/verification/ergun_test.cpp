// Water that falls from one leg of a tank through a bed of coarse grains into the other: Ergun's law without
// Darcy's limit. Quasi-steady, ρ g Δ = (a U + b U²) L with U = −½ dΔ/dt, integrated in small steps.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/recorder.hpp"

namespace quicksand::test {
namespace {

constexpr double kLeg = 0.1, kBed = 0.12, kHigh = 0.5, kLow = 0.3, kPorosity = 0.4, kGrain = 2e-3;

/// The bed fills the right leg from 0.1 m up; the legs are joined below it.
Scene tank(double h, bool fixed) {
  Scene s;
  s.name = "Ergun";
  s.domain.max = {2 * kLeg, 0.64, 0};
  s.domain.cell_size = h;
  Soil coarse;
  coarse.porosity = kPorosity;
  coarse.permeability = {.law = PermeabilityLaw::ergun, .grain_size = kGrain};
  coarse.model.young_modulus = 1e6;
  s.soils["coarse"] = coarse;
  const auto add = [&](const char* name, BodyKind kind, const Region& region) {
    Body body;
    body.name = name, body.kind = kind, body.region = region;
    if (kind != BodyKind::water) body.soil = "coarse", body.fixed = fixed;
    s.bodies.push_back(body);
  };
  add("left", BodyKind::water, box(0, 0, kLeg, kHigh));
  add("below", BodyKind::water, box(kLeg, 0, 2 * kLeg, 0.1));
  add("bed", BodyKind::saturated_soil, box(kLeg, 0.1, 2 * kLeg, 0.1 + kBed));
  add("right", BodyKind::water, box(kLeg, 0.1 + kBed, 2 * kLeg, kLow));
  Wall wall;
  wall.name = "between";
  wall.line = Segment{{kLeg, 0.1, 0}, {kLeg, 0.64, 0}};
  s.walls = {wall};
  Stage stage;
  stage.name = "fall";
  stage.duration = 2;
  s.stages = {stage};
  s.output.series_interval = 0.02;
  s.output.frame_interval = 1;
  for (const double x : {0.5 * kLeg, 1.5 * kLeg}) {
    Probe probe;
    probe.name = x < kLeg ? "left" : "right";
    probe.at = {x, 0.24, 0};
    probe.quantity = "head";
    s.output.probes.push_back(probe);
  }
  return s;
}

/// Difference of levels `t` seconds after it was `delta`.
double difference(double delta, double t) {
  const double n = kPorosity, a = 150 * 1e-3 * (1 - n) * (1 - n) / (n * n * n * kGrain * kGrain),
               b = 1.75 * 1000 * (1 - n) / (n * n * n * kGrain);
  constexpr double dt = 1e-4;
  for (double now = 0; now < t; now += dt) {
    const double drop = 1000 * 9.81 * delta / kBed;
    delta -= 2 * dt * 2 * drop / (a + std::sqrt(a * a + 4 * b * drop));
  }
  return delta;
}

TEST(Ergun, FallingHeadThroughCoarseGrains) {
  const Recorded r = record(tank(0.02, true));
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const auto left = r.results.series("probe.left"), right = r.results.series("probe.right");
  // The levels swing across their legs, 0.36 s a period: means over one period, the first when the flow has
  // got going, because its inertia is not in the reference.
  constexpr std::size_t kPeriod = 18;
  const auto mean = [&](std::size_t from) {
    double sum = 0;
    for (std::size_t i = from; i < from + kPeriod; ++i) sum += left[i] - right[i];
    return sum / kPeriod;
  };
  const std::size_t first = 15, last = left.size() - kPeriod;
  const double expected = difference(mean(first), r.results.times[last] - r.results.times[first]);
  std::printf("levels differ by %.5f m, expected %.5f m, %ld steps\n", mean(last), expected, r.report.steps);
  EXPECT_NEAR(mean(last), expected, 0.01 * (kHigh - kLow));
  EXPECT_LT(difference(kHigh - kLow, 2), 0.5 * (kHigh - kLow));  // enough has flowed to tell
}

}  // namespace
}  // namespace quicksand::test
