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

TEST(StepBounds, ExplicitPressureIsBoundByTheFastestWave) {
  Scene s = test::plane(1, 1, 0.1);
  s.gravity = {};
  s.water.viscosity = 0;
  s.water.bulk_modulus = 1.6e7;  // Pa: sound at 126 m/s
  s.numerics.pressure = PressureScheme::explicit_scheme;
  const double along_axis = 0.1 / std::sqrt(1.6e4);
  const auto bounds = step_bounds(s, {3e-3, 0});
  EXPECT_EQ(names(bounds), (std::vector<std::string>{"soil wave", "water wave"}));
  EXPECT_NEAR(seconds(bounds, "water wave"), along_axis / 2, 1e-15);  // √(2D)
  EXPECT_EQ(seconds(step_bounds(s, {3e-3, 0, true, 2e-4}), "water wave"), 1e-4);
  EXPECT_TRUE(step_bounds(s, {kNone, 0, false}).empty());  // no water
  Scene cube = test::space({1, 1, 1}, 0.1);
  cube.water = s.water, cube.numerics = s.numerics;
  EXPECT_NEAR(seconds(step_bounds(cube, {kNone, 0}), "water wave"), along_axis / std::sqrt(6.0), 1e-15);
}

TEST(StepBounds, TellsWhichWaveAStepOutruns) {
  Scene s = test::plane(1, 1, 0.1);
  s.numerics.pressure = PressureScheme::explicit_scheme;
  const StepSituation now{1e-3, 100, true, 2e-5};
  EXPECT_FALSE(outrun_wave(s, now, 0.99e-5));
  EXPECT_EQ(outrun_wave(s, now, 1.01e-5)->name, "water wave");
  EXPECT_EQ(outrun_wave(s, now, 1.01e-3)->name, "soil wave");
  s.numerics.pressure = PressureScheme::implicit;
  EXPECT_FALSE(outrun_wave(s, now, 0.99e-3));
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
