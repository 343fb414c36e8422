#include "engine/plan/step_bounds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/engine/small_scene.hpp"

namespace quicksand {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

std::vector<std::string> names(const std::vector<StepBound>& bounds) {
  std::vector<std::string> n;
  for (const StepBound& b : bounds) n.push_back(b.name);
  return n;
}

double seconds(const std::vector<StepBound>& bounds, const std::string& name) {
  for (const StepBound& b : bounds)
    if (b.name == name) return b.seconds;
  return 0;
}

TEST(StepBounds, EachHasItsNameAndValue) {
  Scene s = test::plane(1, 1, 0.1);
  s.water.viscosity = 2;
  const auto bounds = step_bounds(s, {3e-4, 2});
  EXPECT_EQ(names(bounds), (std::vector<std::string>{"soil wave", "motion", "surface wave", "viscosity"}));
  EXPECT_EQ(seconds(bounds, "soil wave"), 3e-4);
  EXPECT_NEAR(seconds(bounds, "motion"), 0.5 * 0.1 / 2, 1e-15);
  EXPECT_NEAR(seconds(bounds, "surface wave"), std::sqrt(0.1 / 9.81), 1e-15);
  EXPECT_NEAR(seconds(bounds, "viscosity"), 0.01 / (4 * 2e-3), 1e-15);
}

TEST(StepBounds, OnlyThoseThatApply) {
  Scene s = test::plane(1, 1, 0.1);
  s.water.viscosity = 0;
  EXPECT_EQ(names(step_bounds(s, {kNone, 0})), std::vector<std::string>{"surface wave"});
  s.gravity = {};
  EXPECT_TRUE(step_bounds(s, {kNone, 0}).empty());
  EXPECT_EQ(choose_step(s, {kNone, 0}).name, "frame interval");
  EXPECT_EQ(choose_step(s, {kNone, 0}).seconds, s.output.frame_interval);
}

TEST(StepBounds, ViscosityKnowsTheDimension) {
  Scene s = test::space({1, 1, 1}, 0.1);
  s.water.viscosity = 2;
  EXPECT_NEAR(seconds(step_bounds(s, {kNone, 0}), "viscosity"), 0.01 / (6 * 2e-3), 1e-15);
}

TEST(StepBounds, DrySoilKnowsNoWaves) {
  const Scene s = test::plane(1, 1, 0.1);
  EXPECT_EQ(names(step_bounds(s, {3e-4, 2, false})), (std::vector<std::string>{"soil wave", "motion"}));
}

TEST(ChooseStep, TheSmallestTimesTheFactor) {
  Scene s = test::plane(1, 1, 0.1);
  s.numerics.time_step_factor = 0.5;
  const StepBound soil = choose_step(s, {3e-4, 2});
  EXPECT_EQ(soil.name, "soil wave");
  EXPECT_NEAR(soil.seconds, 1.5e-4, 1e-18);
  const StepBound fast = choose_step(s, {3e-4, 1000});
  EXPECT_EQ(fast.name, "motion");
  EXPECT_NEAR(fast.seconds, 0.5 * 0.5 * 0.1 / 1000, 1e-18);
}

TEST(ChooseStep, AFixedStepIsTakenAsItIs) {
  Scene s = test::plane(1, 1, 0.1);
  s.numerics.time_step = 0.02;
  s.numerics.time_step_factor = 0.5;
  const StepBound fixed = choose_step(s, {3e-4, 2});
  EXPECT_EQ(fixed.name, "numerics.time_step");
  EXPECT_EQ(fixed.seconds, 0.02);
}

}  // namespace
}  // namespace quicksand
