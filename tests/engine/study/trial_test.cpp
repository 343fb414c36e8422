#include "engine/study/trial.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/study/calibrate.hpp"
#include "tests/engine/small_scene.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand {
namespace {

using test::add_body;

/// A column of water that falls apart: at rest at first, so that nothing but events bounds a plan's step.
Scene collapse() {
  Scene s = test::plane(1, 0.6, 0.02, 0.3);
  add_body(s, "column", BodyKind::water, {0, 0, 0}, {0.2, 0.4, 0});
  s.output.frame_interval = s.output.series_interval = 0.15;
  return s;
}

double steps_of(const Scene& s) { return static_cast<double>(test::record(s, 1).report.steps); }

/// The plan after a trial of at most `budget` seconds.
Plan foretold(const Scene& s, double budget = 200) {
  Plan plan = make_plan(s);
  foretell(make_trial(s, {}, budget), s, {}, plan);
  return plan;
}

TEST(Trial, TellsStepsOfAFlowThatSpeedsUp) {
  const Scene s = collapse();
  const double steps = steps_of(s);
  EXPECT_LT(make_plan(s).steps, 0.7 * steps);
  const Plan plan = foretold(s);
  ASSERT_TRUE(plan.trial);
  EXPECT_EQ(plan.trial->cell_size, 0.02);  // all of it, in much less than the budget
  EXPECT_EQ(plan.trial->fraction, 1);
  EXPECT_EQ(plan.steps, steps);
}

/// The scene itself takes too long for its trial: it goes a part of its way, and larger cells all of it.
TEST(Trial, OnLargerCellsTellsTheSteps) {
  Scene s = collapse();
  s.numerics.cell_size_factor = 0.25;
  const double steps = steps_of(s);
  const Trial trial = make_trial(s, {}, 0.2);
  Plan plan = make_plan(s);
  foretell(trial, s, {}, plan);
  ASSERT_TRUE(plan.trial);
  EXPECT_GE(plan.trial->cell_size, 2 * s.cell_size());
  if (plan.trial->fraction == 1) {  // not where a sanitizer slows it down
    EXPECT_GT(trial.larger.step, 0);
    EXPECT_NEAR(plan.steps / steps, 1, 0.2);
  }
}

/// Seconds of a step by those on two sizes.
TEST(Trial, TellsSecondsByTwoSizes) {
  const Scene s = collapse();
  const auto seconds_of = [&](const Pace& larger, const Pace& own) {
    Trial trial;
    trial.figures.cell_size = s.cell_size();
    trial.moments = {{0, 0, {}}};
    trial.larger = larger, trial.own = own;
    Plan plan = make_plan(s);
    const double others = plan.seconds - Calibration{}.seconds(s, plan.steps, 800);
    foretell(trial, s, {}, plan);
    return (plan.seconds - others) / plan.steps;
  };
  EXPECT_EQ(make_plan(s).water_points, 800u);
  EXPECT_NEAR(seconds_of({200, 20e-6}, {800, 80e-6}), 80e-6, 1e-9);
  EXPECT_NEAR(seconds_of({100, 30e-6}, {400, 60e-6}), 100e-6, 1e-9);
  EXPECT_NEAR(seconds_of({100, 1e-6}, {400, 60e-6}), 120e-6, 1e-9);  // a step alone takes something
  EXPECT_NEAR(seconds_of({100, 90e-6}, {400, 60e-6}), 60e-6, 1e-9);  // so does a point
  const Calibration usual;
  EXPECT_NEAR(seconds_of({200, 2 * usual.seconds(s, 1, 200)}, {}), 2 * usual.seconds(s, 1, 800), 1e-9);
}

TEST(Trial, TellsWhenAStageComesToRest) {
  Scene s = test::plane(0.2, 1, 0.025, 20);
  add_body(s, "column", BodyKind::soil, {0, 0, 0}, {0.2, 0.8, 0});
  s.initial.stress = InitialStress::zero;
  s.stages[0].damping = 0.7;
  s.stages[0].until_rest = UntilRest{};
  s.output.frame_interval = s.output.series_interval = 1;
  const double steps = steps_of(s);
  EXPECT_GT(make_plan(s).steps, 5 * steps);
  EXPECT_NEAR(foretold(s).steps / steps, 1, 0.01);
}

/// On cells of the same size the walk is the run, through every event and stage.
TEST(Trial, OnTheScenesOwnCellsCountsEveryStep) {
  Scene s = test::plane(0.3, 0.7, 0.1, 0.031);
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.3, 0.3, 0});
  add_body(s, "pool", BodyKind::water, {0, 0.3, 0}, {0.3, 0.5, 0});
  s.output.series_interval = 0.0043, s.output.frame_interval = 0.01;
  Stage second = s.stages[0];
  second.name = "second", second.duration = 0.02, second.damping = 0.5;
  s.stages.push_back(second);
  const Plan plan = foretold(s);
  ASSERT_TRUE(plan.trial);
  EXPECT_EQ(plan.trial->cell_size, s.cell_size());
  EXPECT_EQ(plan.steps, steps_of(s));
}

TEST(Trial, StoppedEarlyTellsByWhatItHasSeen) {
  const Scene s = collapse();
  int asked = 0;
  const Trial trial = make_trial(s, {}, 10, [&] { return ++asked > 15; });
  EXPECT_EQ(trial.missing, "");
  EXPECT_EQ(trial.figures.steps, 15);
  EXPECT_GT(trial.figures.fraction, 0);
  EXPECT_LT(trial.figures.fraction, 1);
  Plan plan = make_plan(s);
  foretell(trial, s, {}, plan);
  EXPECT_GT(plan.steps, make_plan(s).steps);
  EXPECT_LT(plan.steps, 3 * steps_of(s));
}

TEST(Trial, IsMissingWhereNothingIsShortEnough) {
  const Plan plan = foretold(collapse(), 1e-6);
  EXPECT_FALSE(plan.trial);
  EXPECT_NE(plan.reasons.back().find("No trial"), std::string::npos);
  EXPECT_EQ(plan.steps, make_plan(collapse()).steps);
}

TEST(Trial, CountsFurtherStepsByThoseBefore) {
  Scene s = collapse();
  s.numerics.time_step = 1e-9;  // 3·10⁸ steps
  Trial trial;
  trial.figures.cell_size = 0.04;
  trial.moments = {{0, 0, {}}};
  Plan plan = make_plan(s);
  foretell(trial, s, {}, plan);
  EXPECT_NEAR(plan.steps, 3e8, 1e3);
}

/// Times are of this machine; what a calibration must be is of the same size in every kind of scene.
TEST(Calibrate, MeasuresEveryKindOfScene) {
  const Calibration measured = calibrate(0.05), usual;
  for (std::size_t k = 0; k < kSceneKinds; ++k) {
    EXPECT_GT(measured.cost[k].point, usual.cost[k].point / 30) << k;
    EXPECT_LT(measured.cost[k].point, usual.cost[k].point * 100) << k;
    EXPECT_GE(measured.cost[k].step, 1e-7) << k;
    EXPECT_LT(measured.cost[k].step, 0.1) << k;  // 0.01 with the sanitizers
  }
}

}  // namespace
}  // namespace quicksand
