#include "engine/plan/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/run/setup.hpp"
#include "tests/engine/small_scene.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand {
namespace {

using test::add_body;

Scene bed() {
  Scene s = test::plane(1, 0.8, 0.1, 0.02);
  add_body(s, "filter", BodyKind::saturated_soil, {0, 0, 0}, {1, 0.1, 0});
  s.bodies.back().fixed = true;
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0.1, 0}, {1, 0.3, 0});
  add_body(s, "pool", BodyKind::water, {0, 0.3, 0}, {1, 0.5, 0});
  return s;
}

TEST(Plan, CountsWhatWillBeSeeded) {
  const Scene s = bed();
  const Plan plan = make_plan(s);
  const State<2> state = make_state<2>(s);
  EXPECT_EQ(plan.soil_points, state.soil.size());
  EXPECT_EQ(plan.fixed_soil_points, state.fixed.size());
  EXPECT_EQ(plan.water_points, state.water.size());
  EXPECT_EQ(plan.water_points, 50u * 4);
  EXPECT_EQ(plan.dimensions, 2);
  EXPECT_EQ(plan.cells, (std::array<int, 3>{10, 8, 1}));
  EXPECT_TRUE(plan.has_soil && plan.has_water && plan.has_viscosity);
  EXPECT_GT(plan.memory_bytes, static_cast<double>(plan.water_points) * sizeof(double) * 7);
}

TEST(Plan, FollowsThePreset) {
  Scene s = bed();
  s.numerics.cell_size_factor = 0.5;
  const Plan plan = make_plan(s);
  EXPECT_EQ(plan.cell_size, 0.05);
  EXPECT_EQ(plan.cells, (std::array<int, 3>{20, 16, 1}));
  EXPECT_EQ(plan.water_points, 200u * 4);
}

TEST(Plan, Space) {
  Scene s = test::space({0.3, 0.4, 0.5}, 0.1);
  add_body(s, "pool", BodyKind::water, {0, 0, 0}, {0.3, 0.4, 0.2});
  const Plan plan = make_plan(s);
  EXPECT_EQ(plan.dimensions, 3);
  EXPECT_EQ(plan.cells, (std::array<int, 3>{3, 4, 5}));
  EXPECT_EQ(plan.water_points, 24u * 8);
  EXPECT_FALSE(plan.has_soil);
}

TEST(Plan, ChoosesTheSmallestBound) {
  const Plan plan = make_plan(bed());
  ASSERT_FALSE(plan.bounds.empty());
  double least = plan.bounds.front().seconds;
  for (const StepBound& b : plan.bounds) least = std::min(least, b.seconds);
  EXPECT_EQ(plan.bound.name, "soil wave");
  EXPECT_NEAR(plan.time_step, 0.8 * least, 1e-15);
  EXPECT_EQ(plan.end_time, 0.02);
  EXPECT_EQ(plan.steps, 2 * std::ceil(0.01 / plan.time_step));  // whole steps between two samples
  EXPECT_GT(plan.seconds, 0);
}

TEST(Plan, StepsAreThoseOfTheRun) {
  const Scene s = bed();
  const Plan plan = make_plan(s);
  const auto r = test::record(s);
  EXPECT_NEAR(static_cast<double>(r.report.steps) / plan.steps, 1, 0.3);
}

/// Stages after a body is gone count with what it leaves: less soil, and a top that lies open.
TEST(Plan, StepsFollowWhatStagesRemove) {
  const auto steps_of = [](const std::vector<std::string>& removed) {
    Scene s = bed();
    s.soils["hard"] = s.soils["sand"];
    s.soils["hard"].model.young_modulus *= 100;
    add_body(s, "lid", BodyKind::saturated_soil, {0, 0.5, 0}, {1, 0.6, 0});
    s.bodies.back().soil = "hard";
    Stage after = s.stages[0];
    after.name = "after", after.remove_bodies = removed;
    s.stages.push_back(after);
    return make_plan(s).steps;
  };
  const double all = steps_of({});
  EXPECT_LT(steps_of({"lid"}), 0.6 * all);  // far longer steps in the second half
  EXPECT_GT(steps_of({"lid"}), 0.5 * all);
  EXPECT_GT(steps_of({"lid", "pool"}), steps_of({"lid"}));  // the bed lies open to the air
}

TEST(Plan, SaysWhatIsLeftOut) {
  const auto says = [](const Plan& plan, const std::string& text) {
    return std::any_of(plan.reasons.begin(), plan.reasons.end(),
                       [&](const std::string& r) { return r.find(text) != std::string::npos; });
  };
  Scene dry = test::plane(1, 1, 0.1);
  add_body(dry, "lump", BodyKind::soil, {0, 0, 0}, {0.5, 0.5, 0});
  const Plan d = make_plan(dry);
  EXPECT_FALSE(d.has_water || d.has_viscosity);
  EXPECT_TRUE(says(d, "No water"));
  Scene wet = test::plane(1, 1, 0.1);
  add_body(wet, "pool", BodyKind::water, {0, 0, 0}, {0.5, 0.5, 0});
  wet.water.viscosity = 0;
  wet.water.bulk_modulus.reset();
  const Plan w = make_plan(wet);
  EXPECT_FALSE(w.has_soil || w.has_viscosity);
  EXPECT_TRUE(says(w, "No soil moves"));
  EXPECT_TRUE(says(w, "No viscosity"));
  EXPECT_TRUE(says(w, "incompressible"));
  EXPECT_TRUE(says(make_plan(bed()), "Fixed soil"));
  EXPECT_FALSE(says(make_plan(bed()), "per radian"));
  Scene round = bed();
  round.domain.dimension = Dimension::axisymmetric;
  EXPECT_TRUE(says(make_plan(round), "per radian"));
}

}  // namespace
}  // namespace quicksand
