// What stages change other than boundaries: inertia, and that weight stays.

#include "engine/run/stage.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/small_scene.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand {
namespace {

using test::add_body;
using test::plane;

/// A saturated bed under a load that begins at once; k = 1e-8 m/s, T = 1 at 7 500 s.
Scene loaded_bed(double duration) {
  Scene s = plane(0.4, 0.6, 0.05, duration);
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.4, 0.4, 0});
  s.soils.at("sand").permeability.value = 1e-8;
  s.soils.at("sand").model.law = SoilLaw::linear_elastic;
  s.soils.at("sand").model.friction_angle = 0;
  Load load;
  load.name = "fill", load.body = "bed", load.traction = {0, -1e3, 0};
  s.loads = {load};
  s.stages[0].quasi_static = true;
  s.output.frame_interval = duration;
  s.output.series_interval = duration / 20;
  return s;
}

Stage stage_of(const std::string& name, double duration, bool quasi_static) {
  Stage stage;
  stage.name = name, stage.duration = duration, stage.quasi_static = quasi_static;
  return stage;
}

TEST(QuasiStatic, SaysThatInertiaIsNegligible) {
  const auto r = test::record(loaded_bed(2000));
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  ASSERT_EQ(r.report.quasi_static.size(), 1u);
  const QuasiStaticReport& q = r.report.quasi_static[0];
  EXPECT_GT(q.inertia, 1e6);
  EXPECT_NEAR(q.process_time / q.transit_time, 200, 1e-9);
  EXPECT_TRUE(q.negligible);
  EXPECT_GT(q.inertia_ratio, 0);
  EXPECT_DOUBLE_EQ(r.results.last("quasi_static.inertia"), q.inertia);
  EXPECT_LT(r.report.steps, 5000);
}

TEST(QuasiStatic, SaysThatInertiaIsNotNegligible) {
  Scene s = loaded_bed(2000);
  s.numerics.quasi_static_transits = 1;
  const auto r = test::record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  EXPECT_GT(r.report.quasi_static.at(0).inertia_ratio, kNegligibleInertia);
  EXPECT_FALSE(r.report.quasi_static[0].negligible);
}

/// Stress and pressure of a bed at rest are those of its weight, whatever the inertia.
TEST(QuasiStatic, WeightIsNotScaled) {
  Scene s = loaded_bed(2000);
  s.loads.clear();
  const auto r = test::record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const auto potential = r.results.series("ledger.energy_potential");
  const double g = 9.81;
  EXPECT_NEAR(r.report.ledger.impulse_gravity[1],
              -g * 2000 * (r.report.ledger.solid_mass + r.report.ledger.water_mass),
              1e-9 * g * 2000 * r.report.ledger.solid_mass);
  EXPECT_NEAR(potential.back(), potential.front(), 1e-4 * potential.front());
  EXPECT_LT(r.report.ledger.momentum_residual, 1e-9);
}

/// Into the slow motion momentum is kept; out of it velocities are, and the ledger holds the difference.
TEST(QuasiStatic, LedgerClosesWhereInertiaChanges) {
  Scene s = loaded_bed(0.01);
  s.stages = {stage_of("shake", 0.01, false), stage_of("settle", 1000, true), stage_of("watch", 0.01, false)};
  s.output.series_interval = s.output.frame_interval = 100;
  const auto r = test::record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const Ledger& l = r.report.ledger;
  EXPECT_LT(l.momentum_residual, 1e-9);
  EXPECT_NE(l.impulse_stages[1], 0);
  EXPECT_LT(r.report.time_step_min, 1e-3);
  EXPECT_GT(r.report.time_step_max, 0.1);
  ASSERT_EQ(r.report.quasi_static.size(), 1u);
  EXPECT_EQ(r.report.quasi_static[0].stage, "settle");
}

}  // namespace
}  // namespace quicksand
