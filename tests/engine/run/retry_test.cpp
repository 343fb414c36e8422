// A step that fails is taken back to the last good state and repeated shorter; only then has a run diverged.

#include <gtest/gtest.h>

#include <cstring>

#include "engine/run/easing.hpp"
#include "tests/engine/run/endings.hpp"
#include "tests/engine/small_scene.hpp"

namespace quicksand {
namespace {

using test::add_body;
using test::expect_clean;
using test::plane;
using test::says;

/// Hits the floor at 10 m/s, nearly without stress: in the step that the soft clay allows, ln p' grows by
/// 1 / 0.003 times the compression, beyond what a number holds.
Scene falling_clay() {
  Scene s = plane(0.6, 1.2, 0.1, 0.06);
  add_body(s, "block", BodyKind::soil, {0, 0.5, 0}, {0.6, 1, 0});
  s.soils["sand"].model = {.law = SoilLaw::modified_cam_clay,
                           .poisson_ratio = 0.3,
                           .compression_slope = 0.015,
                           .swelling_slope = 0.003,
                           .critical_state_slope = 1,
                           .over_consolidation_ratio = 4};
  s.bodies[0].velocity = {0, -10, 0};
  s.initial.stress = InitialStress::uniform;
  s.initial.uniform_stress = {-10, -10, -10, 0, 0, 0};
  s.output.frame_interval = 0.01;
  s.output.series_interval = 0.002;
  return s;
}

/// A blow on the ground that no step is short enough for.
Scene blow() {
  Scene s = plane(1, 0.8, 0.1, 1);
  add_body(s, "bank", BodyKind::soil, {0, 0, 0}, {1, 0.4, 0});
  Load load;
  load.name = "blow", load.body = "bank", load.traction = {0, -1e18, 0};
  s.loads.push_back(load);
  s.output.frame_interval = 0.05;
  s.output.series_interval = 0.01;
  return s;
}

struct Monitor final : RunMonitor {
  std::string lines;
  long steps = 0, suspend = -1;
  void log(const std::string& line) override { lines += line + '\n'; }
  void progress(const Progress& now) override { steps = now.step; }
  bool suspended() override { return steps == suspend; }
};

struct Sink final : test::Recorder {
  Checkpoint saved;
  void checkpoint(const Checkpoint& made) override { saved = made; }
};

RunOptions options(int retries, long good_every = 5) {
  RunOptions chosen{1};
  chosen.retries = retries;
  chosen.good_every = good_every;
  return chosen;
}

void expect_same(const test::Recorder& a, const test::Recorder& b) {
  ASSERT_EQ(a.times, b.times);
  for (const char* name : {"ledger.energy", "max_speed", "time_step", "ledger.retries"})
    EXPECT_EQ(a.series(name), b.series(name)) << name;
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    EXPECT_EQ(a.frames[i].time, b.frames[i].time);
    EXPECT_EQ(a.frames[i].position == b.frames[i].position, true) << i;
  }
}

TEST(Retry, AStepThatFailsIsRepeatedShorter) {
  Monitor ignored, monitor;
  Sink without, results;
  const RunReport failed = run(falling_clay(), without, ignored, options(0));
  ASSERT_EQ(failed.status == RunStatus::failed, true) << ignored.lines;
  EXPECT_EQ(failed.failure.code, "diverged");
  EXPECT_TRUE(says(failed.failure.message, "numerics.time_step_factor")) << failed.failure.message;

  const RunReport report = run(falling_clay(), results, monitor, options(6));
  ASSERT_EQ(report.status, RunStatus::succeeded) << report.failure.message;
  EXPECT_GE(report.ledger.retries, 1);
  EXPECT_EQ(results.last("ledger.retries"), static_cast<double>(report.ledger.retries));
  EXPECT_TRUE(says(monitor.lines, "Back at t = ")) << monitor.lines;
  double eased = 0, all = 0;
  for (const StepBound& bound : report.steps_bound_by) {
    all += bound.seconds;
    if (bound.name == "retry") eased += bound.seconds;
  }
  EXPECT_GT(eased, 0);
  EXPECT_LT(eased, all);                              // steps grow again
  EXPECT_NEAR(all, 0.06, 1e-12);                      // what was taken back does not count
  EXPECT_EQ(results.frames.size(), 7u);               // nor show
  EXPECT_LT(report.ledger.momentum_residual, 1e-10);  // nor push
  EXPECT_LE(report.ledger.energy_kinetic, 0.5 * 10.5 * 10.5 * report.ledger.solid_mass);
  EXPECT_EQ(report.ledger.solid_mass, report.ledger.solid_mass_initial);
  expect_clean(results);
}

TEST(Retry, IsTheSameOnAnyNumberOfThreads) {
  Sink one, three;
  Monitor monitor;
  RunOptions on_three = options(6);
  on_three.threads = 3;
  EXPECT_GE(run(falling_clay(), one, monitor, options(6)).ledger.retries, 1);
  run(falling_clay(), three, monitor, on_three);
  expect_same(one, three);
}

TEST(Retry, IsTheSameInARunThatWasResumed) {
  Sink straight;
  Monitor monitor;
  const RunReport whole = run(falling_clay(), straight, monitor, options(6));
  ASSERT_GE(whole.ledger.retries, 1);
  for (const long at : {1L, 18L, 23L, 200L}) {
    Sink parts;
    Monitor first, rest;
    first.suspend = at;
    ASSERT_EQ(run(falling_clay(), parts, first, options(6)).status, RunStatus::suspended);
    const Checkpoint checkpoint = parts.saved;
    EXPECT_EQ(checkpoint.frames, parts.frames.size());
    EXPECT_EQ(checkpoint.samples, parts.times.size());
    RunOptions resumed = options(6);
    resumed.resume = &checkpoint;
    const RunReport report = run(falling_clay(), parts, rest, resumed);
    EXPECT_EQ(report.steps, whole.steps);
    EXPECT_EQ(report.ledger.retries, whole.ledger.retries);
    expect_same(straight, parts);
  }
}

TEST(Retry, WhatNoStepIsShortEnoughForHasDiverged) {
  Sink results;
  Monitor monitor;
  const RunReport report = run(blow(), results, monitor, options(6));
  ASSERT_EQ(report.status, RunStatus::failed);
  EXPECT_EQ(report.failure.code, "diverged");
  EXPECT_EQ(report.ledger.retries, 6);
  const std::string& m = report.failure.message;
  EXPECT_TRUE(says(m, "that 'motion' allows")) << m;
  EXPECT_TRUE(says(m, "t = ")) << m;                        // when
  EXPECT_TRUE(says(m, "soil of body 'bank' near (")) << m;  // which phase, where
  EXPECT_TRUE(says(m, "Steps down to 1/64 as long")) << m;  // what was tried
  EXPECT_TRUE(says(m, "a load")) << m;                      // cause
  EXPECT_TRUE(says(m, "ramp")) << m;                        // remedy
  EXPECT_FALSE(says(m, "time_step_factor")) << m;           // which would not help
  expect_clean(results);
}

TEST(Retry, StepsGrowAgainWhereNothingFails) {
  Easing easing;
  EXPECT_EQ(easing.shortened({"motion", 1}).seconds, 1);
  EXPECT_TRUE(easing.shorten(2));
  EXPECT_TRUE(easing.shorten(2));
  EXPECT_FALSE(easing.shorten(2));
  EXPECT_EQ(easing.shortened({"motion", 1}).seconds, 0.25);
  EXPECT_EQ(easing.shortened({"motion", 1}).name, "retry");
  easing.came_through();  // past the place
  EXPECT_EQ(easing.factor(), 0.25);
  easing.came_through();
  EXPECT_EQ(easing.factor(), 0.5);
  easing.came_through();
  easing.came_through();
  EXPECT_EQ(easing.factor(), 1);
}

}  // namespace
}  // namespace quicksand
