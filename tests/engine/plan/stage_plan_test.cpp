#include "engine/plan/stage_plan.hpp"

#include <gtest/gtest.h>

namespace quicksand {
namespace {

using Sentences = std::vector<std::string>;

/// A pit that is filled, drained and dug out.
Scene pit() {
  Scene s;
  s.gates = {{"valve", {}}, {"sluice", {}}};
  s.reservoirs = {{"lake", {}, 2}, {"drain", {}, 0.5}};
  s.loads.resize(2);
  s.loads[0].name = "road", s.loads[0].body = "clay", s.loads[0].ramp = 0.25;
  s.loads[1].name = "crane", s.loads[1].body = "fill";
  s.stages.resize(3);
  s.stages[0].name = "rest", s.stages[0].duration = 10;
  s.stages[0].loads = Sentences{};
  s.stages[0].damping = 0.5;
  s.stages[0].until_rest = UntilRest{1e-3, 2};
  s.stages[1].name = "drain", s.stages[1].duration = 5;
  s.stages[1].open_gates = {"valve"};
  s.stages[1].heads = {{"drain", 0.25}};
  s.stages[1].heads_ramp = 3;
  s.stages[2].name = "dig", s.stages[2].duration = 1e6;
  s.stages[2].remove_bodies = {"fill"};
  s.stages[2].heads = {{"lake", 1.5}};
  s.stages[2].quasi_static = true;
  return s;
}

TEST(StagePlan, SaysWhatEachStageDoes) {
  const auto stages = plan_stages(pit());
  ASSERT_EQ(stages.size(), 3u);
  EXPECT_EQ(stages[1].name, "drain");
  EXPECT_EQ(stages[1].begin, 10);
  EXPECT_EQ(stages[2].end, 1e6 + 15);
  EXPECT_EQ(
      stages[0].does,
      (Sentences{
          "Gates closed: valve, sluice.", "Reservoir lake: level 2 m.", "Reservoir drain: level 0.5 m.",
          "Damping 0.5: that share of the out-of-balance force is turned against the motion; what rests is "
          "right, the way there is not.",
          "Ends at rest: when no point is faster than 0.001 m/s, not before 2 s of it."}));
  EXPECT_EQ(stages[1].does,
            (Sentences{"Gates open: valve.", "Gates closed: sluice.", "Reservoir lake: level 2 m.",
                       "Reservoir drain: level 0.5 m, then 0.25 m over 3 s.",
                       "Load road begins, rising over 0.25 s.", "Load crane begins with its full value."}));
  EXPECT_EQ(
      stages[2].does,
      (Sentences{"Removes: fill; grains and water leave from wherever they are by then.",
                 "Gates closed: valve, sluice.", "Reservoir lake: level 2 m, then 1.5 m at once.",
                 "Reservoir drain: level 0.25 m.", "Load road goes on.", "Load crane ends.",
                 "Quasi-static: inertia, never weight, is scaled so that a wave crosses the soil 200 times "
                 "within the process; whatever falls is slower than in nature."}));
}

TEST(StagePlan, WarnsOfFreeWaterInASlowStage) {
  Scene s = pit();
  s.bodies.resize(1);
  s.bodies[0].name = "fill", s.bodies[0].kind = BodyKind::water;
  s.stages[1].quasi_static = true;
  const auto stages = plan_stages(s);
  EXPECT_NE(stages[1].does.back().find("Free water"), std::string::npos);
  EXPECT_EQ(stages[2].does.back().find("Free water"), std::string::npos);  // removed by then
}

TEST(StagePlan, ASimpleStageOnlyTakesTime) {
  Scene s;
  s.stages.resize(1);
  s.stages[0].duration = 2;
  EXPECT_TRUE(plan_stages(s).front().does.empty());
}

}  // namespace
}  // namespace quicksand
