// Runs that end before their time say why, and leave clean results.

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "engine/run/diagnosis.hpp"
#include "engine/run/setup.hpp"
#include "tests/engine/run/endings.hpp"
#include "tests/engine/small_scene.hpp"

namespace quicksand {
namespace {

using test::add_body;
using test::expect_clean;
using test::plane;
using test::says;

Scene bank(double duration) {
  Scene s = plane(1, 0.8, 0.1, duration);
  add_body(s, "bank", BodyKind::soil, {0, 0, 0}, {0.4, 0.4, 0});
  s.output.frame_interval = 0.05;
  s.output.series_interval = 0.01;
  return s;
}

TEST(Failure, AFixedStepFarTooLargeDiverges) {
  Scene s = bank(1000);
  s.numerics.time_step = 0.05;  // 40 times the bound
  s.numerics.max_steps = 5000;
  const auto r = test::record(s);
  ASSERT_EQ(r.report.status, RunStatus::failed);
  EXPECT_EQ(r.report.failure.code, "diverged");
  const std::string& m = r.report.failure.message;
  EXPECT_TRUE(says(m, "t = ")) << m;                 // when
  EXPECT_TRUE(says(m, "near (")) << m;               // where
  EXPECT_TRUE(says(m, "soil of body 'bank'")) << m;  // which phase
  EXPECT_TRUE(says(m, "numerics.time_step")) << m;   // cause
  EXPECT_TRUE(says(m, "leave it out")) << m;         // remedy
  expect_clean(r.results);
}

/// A plate driven into saturated soil that fills a box from wall to wall; its water cannot be compressed. How
/// soon that shows is a matter of rounding.
TEST(Failure, WaterWithoutRoomIsNamed) {
  Scene s = plane(0.4, 0.6, 0.1, 1);
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.4, 0.4, 0});
  s.water.bulk_modulus.reset();
  Load plate;
  plate.name = "plate", plate.kind = Load::Kind::plate, plate.body = "bed";
  plate.plate = {{0, 0.4, 0}, {0.4, 0.4, 0}};
  plate.plate_velocity = {0, -0.1, 0};
  s.loads = {plate};
  s.output.frame_interval = s.output.series_interval = 0.05;
  const auto r = test::record(s);
  ASSERT_EQ(r.report.status, RunStatus::failed);
  EXPECT_EQ(r.report.failure.code, "diverged");
  EXPECT_TRUE(says(r.report.failure.message, "water without room")) << r.report.failure.message;
  EXPECT_TRUE(says(r.report.failure.message, "bulk_modulus")) << r.report.failure.message;
  expect_clean(r.results);
}

/// A column of water that falls apart with its feedback switched off ends with a caution; at rest with none.
TEST(Failure, WaterThatLostRoomIsToldWithTheAnswer) {
  Scene s = plane(0.8, 0.6, 0.1, 2);
  add_body(s, "column", BodyKind::water, {0, 0, 0}, {0.2, 0.5, 0});
  s.numerics.drift_time = 0;
  s.output.frame_interval = 2, s.output.series_interval = 0.05;
  const auto r = test::record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded);
  ASSERT_EQ(r.report.cautions.size(), 1u);
  EXPECT_TRUE(says(r.report.cautions.front(), "numerics.drift_time of 0 s")) << r.report.cautions.front();
  s.bodies[0].region.max = {0.8, 0.4, 0};
  EXPECT_TRUE(test::record(s).report.cautions.empty());
}

TEST(Failure, TooManySteps) {
  Scene s = bank(1);
  s.numerics.max_steps = 12;
  const auto r = test::record(s);
  ASSERT_EQ(r.report.status, RunStatus::failed);
  EXPECT_EQ(r.report.failure.code, "max_steps");
  EXPECT_EQ(r.report.steps, 12);
  EXPECT_TRUE(says(r.report.failure.message, "numerics.max_steps = 12"));
  EXPECT_EQ(r.results.frames.back().time, r.report.sim_time);
  expect_clean(r.results);
}

TEST(Failure, NamesTheWorstPoint) {
  Scene s = plane(1, 1, 0.1);
  add_body(s, "pool", BodyKind::water, {0, 0, 0}, {1, 0.5, 0});
  add_body(s, "lump", BodyKind::soil, {0, 0.6, 0}, {0.3, 0.8, 0});
  State<2> state = make_state<2>(s);
  state.time = 1.25;
  state.soil.v[0] = {1e6, 0};
  state.water.v[10] = {std::nan(""), 0};
  const Failure f = not_finite(s, state);
  EXPECT_EQ(f.code, "diverged");
  EXPECT_EQ(f.time, 1.25);
  EXPECT_EQ(f.place[0], state.water.x[10][0]);
  EXPECT_EQ(f.place[1], state.water.x[10][1]);
  EXPECT_TRUE(says(f.message, "t = 1.25 s, first in water of body 'pool' near (")) << f.message;
  EXPECT_TRUE(says(f.message, "numerics.time_step_factor")) << f.message;
  state.water.v[10] = {0, 0};
  const Failure fast = collapsed_step(s, state, {"motion", 1e-9});
  EXPECT_TRUE(says(fast.message, "soil of body 'lump'")) << fast.message;
  EXPECT_TRUE(says(fast.message, "1e+06 m/s")) << fast.message;
  EXPECT_TRUE(says(fast.message, "'motion'")) << fast.message;
  EXPECT_TRUE(says(pressure_not_found(s, state, 0.5).message, "numerics.pressure_tolerance"));
}

/// A sink whose disk is full from the n-th call on.
struct FullDisk : test::Recorder {
  int room;
  explicit FullDisk(int calls) : room(calls) {}
  void use() {
    if (room-- <= 0) throw std::runtime_error("cannot write Points: No space left on device");
  }
  void begin(const std::vector<SeriesInfo>& s) override { use(), Recorder::begin(s); }
  void frame(Frame f) override { use(), Recorder::frame(std::move(f)); }
  void sample(double t, const std::vector<double>& v) override { use(), Recorder::sample(t, v); }
};

TEST(Failure, ASinkThatCannotStoreFailsTheRunAsOutput) {
  for (const int room : {0, 1, 2, 8}) {
    FullDisk sink(room);
    struct Log : RunMonitor {
      std::string lines;
      void log(const std::string& line) override { lines += line + '\n'; }
    } monitor;
    const RunReport report = run(bank(0.5), sink, monitor);
    EXPECT_EQ(report.status, RunStatus::failed);
    EXPECT_EQ(report.failure.code, "output");
    EXPECT_TRUE(says(report.failure.message, "No space left on device"));
    EXPECT_TRUE(says(monitor.lines, "No space left on device"));
  }
}

}  // namespace
}  // namespace quicksand
