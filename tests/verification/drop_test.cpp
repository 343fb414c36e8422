// Single drops do not know the water below them until they reach it.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/recorder.hpp"

namespace quicksand::test {
namespace {

Body water(const std::string& name, const Region& region) {
  Body b;
  b.name = name;
  b.region = region;
  return b;
}

/// One point over a pool falls as v² = 2 g s until its kernel meets the pool's, and then joins it.
TEST(Drop, FallsFreelyAndJoinsThePool) {
  constexpr double kEdge = 0.01, kPool = 0.1, kHeight = 0.15, kStep = 0.002;
  Scene s;
  s.domain.max = {0.2, 0.3, 0};
  s.domain.cell_size = kEdge;
  s.bodies = {water("pool", box(0, 0, 0.2, kPool)), water("drop", box(0.1, kHeight, 0.105, kHeight + 0.005))};
  Stage stage;
  stage.name = "fall";
  stage.duration = 0.3;
  s.stages = {stage};
  s.output.frame_interval = kStep;
  s.numerics.time_step = kStep;
  const Recorded r = record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const double start = kHeight + 0.0025;
  double last_height = 1;
  for (const Frame& frame : r.results.frames)
    for (std::size_t p = 0; p < frame.points(); ++p) {
      if (frame.body[p] != 1) continue;
      last_height = frame.position[3 * p + 1];
      if (last_height < kPool + 2.5 * kEdge) continue;
      // Positions follow the new velocity of each step: ½ g t Δt further down than the parabola.
      const double parabola = start - 0.5 * 9.81 * frame.time * frame.time;
      EXPECT_NEAR(last_height, parabola - 0.5 * 9.81 * frame.time * kStep, 1e-6)
          << "at " << frame.time << " s";
    }
  EXPECT_LT(last_height, kPool + 0.5 * kEdge);
  EXPECT_LT(r.report.ledger.momentum_residual, 1e-9);
}

/// Drops beside a thin wall fall though water stands on its other side.
TEST(Drop, IsNotHeldThroughAThinWall) {
  Scene s;
  s.domain.max = {0.2, 0.3, 0};
  s.domain.cell_size = 0.01;
  Wall wall;
  wall.name = "wall";
  wall.line = Segment{{0.1, 0, 0}, {0.1, 0.3, 0}};
  s.walls = {wall};
  s.bodies = {water("tank", box(0, 0, 0.1, 0.2)), water("drop", box(0.1, 0.15, 0.105, 0.155))};
  Stage stage;
  stage.name = "fall";
  stage.duration = 0.1;
  s.stages = {stage};
  s.numerics.time_step = 1e-4;
  const Recorded r = record(s);
  const Frame& last = r.results.frames.back();
  for (std::size_t p = 0; p < last.points(); ++p)
    if (last.body[p] == 1) {
      EXPECT_NEAR(last.position[3 * p + 1], 0.1525 - 0.5 * 9.81 * 0.01, 1e-3);
    }
}

}  // namespace
}  // namespace quicksand::test
