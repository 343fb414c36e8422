#include "engine/plan/settings_choice.hpp"

#include <gtest/gtest.h>

#include "engine/plan/expected_error.hpp"
#include "engine/plan/plan.hpp"
#include "engine/scene/preset.hpp"
#include "tests/engine/small_scene.hpp"

namespace quicksand {
namespace {

/// 40 by 24 cells, half of them saturated; cells 1.5 and 3 times as large do not fit.
Scene shallow_bed() {
  Scene scene = test::plane(0.4, 0.24, 0.01, 0.02);
  test::add_body(scene, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.4, 0.12, 0});
  scene.soils.at("sand").model.law = SoilLaw::linear_elastic;
  return scene;
}

SettingsChoice choose(Scene scene, std::optional<double> error, std::optional<double> budget) {
  scene.numerics.target_error = error;
  scene.numerics.budget_seconds = budget;
  return choose_settings(
      [&](Preset preset) {
        Scene with = scene;
        apply_preset(preset, with.numerics);
        return with;
      },
      {});
}

TEST(ExpectedError, IsThatOfThePresetsAndFallsWithTheCells) {
  Scene scene = shallow_bed();
  EXPECT_DOUBLE_EQ(expected_error(scene), 0.016);
  double before = 1;
  for (const double factor : {8.0, 4.0, 2.0, 1.5, 1.0, 0.75, 0.5, 0.25, 0.1}) {
    scene.numerics.cell_size_factor = factor;
    EXPECT_LT(expected_error(scene), before) << factor;
    before = expected_error(scene);
  }
  apply_preset(Preset::draft, scene.numerics);
  EXPECT_DOUBLE_EQ(expected_error(scene), 0.025);
  apply_preset(Preset::fine, scene.numerics);
  EXPECT_DOUBLE_EQ(expected_error(scene), 0.008);
}

TEST(ExpectedError, GrowsWhereNothingIsResolved) {
  Scene coarse = test::plane(0.4, 0.24, 0.08, 0.02);
  test::add_body(coarse, "block", BodyKind::soil, {0, 0, 0}, {0.4, 0.16, 0});
  coarse.soils.at("sand").model.law = SoilLaw::linear_elastic;
  EXPECT_DOUBLE_EQ(expected_error(coarse), 0.016 * 10 / 5);
}

TEST(ExpectedError, CountsWhatMayYieldOrRunAway) {
  Scene scene = shallow_bed();
  EXPECT_EQ(error_class(scene), ErrorClass::smooth);
  scene.soils.at("sand").model.law = SoilLaw::mohr_coulomb;
  EXPECT_EQ(error_class(scene), ErrorClass::yielding);
  scene.bodies[0].fixed = true;  // its stress is not computed
  EXPECT_EQ(error_class(scene), ErrorClass::smooth);
  test::add_body(scene, "pond", BodyKind::water, {0, 0.12, 0}, {0.4, 0.2, 0});
  EXPECT_EQ(error_class(scene), ErrorClass::smooth);
  scene.gates.emplace_back();
  EXPECT_EQ(error_class(scene), ErrorClass::free_water);
  scene.gates.clear();
  scene.domain.sides[1].kind = SideKind::open;
  EXPECT_EQ(error_class(scene), ErrorClass::free_water);
  Scene tank = test::plane(0.4, 0.24, 0.01, 0.02);
  test::add_body(tank, "tank", BodyKind::water, {0, 0, 0}, {0.4, 0.2, 0});
  EXPECT_EQ(error_class(tank), ErrorClass::free_water);
}

TEST(SettingsChoice, TakesTheLargestCellsWithinTheTargetError) {
  const SettingsChoice choice = choose(shallow_bed(), 0.02, {});
  ASSERT_TRUE(choice.scene);
  EXPECT_EQ(choice.scene->numerics.cell_size_factor,
            4.0 / 3);  // the next that fit, twice as large, err by 0.025
  EXPECT_LE(expected_error(*choice.scene), 0.02);
  EXPECT_NE(choice.scene->numerics.chosen.find("0.0133333333 m"), std::string::npos)
      << choice.scene->numerics.chosen;
  EXPECT_NE(choice.scene->numerics.chosen.find("0.02"), std::string::npos);
}

TEST(SettingsChoice, TakesTheSmallestCellsWithinTheBudget) {
  Scene draft = shallow_bed(), standard = shallow_bed();
  apply_preset(Preset::draft, draft.numerics);
  const double enough = make_plan(standard).seconds;
  const SettingsChoice choice = choose(shallow_bed(), {}, enough * 1.0001);
  ASSERT_TRUE(choice.scene);
  EXPECT_EQ(choice.scene->numerics.cell_size_factor, 1);
  const SettingsChoice less = choose(shallow_bed(), {}, enough * 0.999);
  ASSERT_TRUE(less.scene);
  EXPECT_GT(less.scene->numerics.cell_size_factor, 1);
  EXPECT_LE(make_plan(*less.scene).seconds, enough);
  const SettingsChoice plenty = choose(shallow_bed(), {}, 1e6);
  ASSERT_TRUE(plenty.scene);
  EXPECT_EQ(plenty.scene->numerics.cell_size_factor, 0.25);
  EXPECT_EQ(plenty.scene->numerics.preset, Preset::fine);
  EXPECT_EQ(plenty.scene->numerics.pressure_tolerance, 1e-7);
}

TEST(SettingsChoice, RefusesWhatCannotBeHadAndSaysWhatCan) {
  const SettingsChoice precise = choose(shallow_bed(), 1e-4, {});
  ASSERT_TRUE(precise.fault);
  EXPECT_FALSE(precise.scene);
  EXPECT_EQ(precise.fault->pointer, "/numerics/target_error");
  for (const char* word : {"0.0001", "0.0025 m", "0.004", "domain.cell_size"})
    EXPECT_NE(precise.fault->detail.find(word), std::string::npos) << precise.fault->detail;

  const SettingsChoice quick = choose(shallow_bed(), {}, 1e-3);
  ASSERT_TRUE(quick.fault);
  EXPECT_EQ(quick.fault->pointer, "/numerics/budget_seconds");
  EXPECT_NE(quick.fault->detail.find("give at least"), std::string::npos) << quick.fault->detail;

  const SettingsChoice both = choose(shallow_bed(), 0.02, 1e-3);
  ASSERT_TRUE(both.fault);
  EXPECT_EQ(both.fault->pointer, "/numerics/budget_seconds");
  EXPECT_NE(both.fault->detail.find("larger target_error"), std::string::npos) << both.fault->detail;
}

TEST(SettingsChoice, WhatTheRefusalNamesIsEnough) {
  const auto named = [](const std::string& detail) {
    const std::string before = "give at least ";
    return std::stod(detail.substr(detail.find(before) + before.size()));
  };
  EXPECT_TRUE(choose(shallow_bed(), {}, named(choose(shallow_bed(), {}, 1e-3).fault->detail)).scene);
  EXPECT_TRUE(choose(shallow_bed(), 0.02, named(choose(shallow_bed(), 0.02, 1e-3).fault->detail)).scene);
  EXPECT_TRUE(choose(shallow_bed(), 0.004, {}).scene);
}

}  // namespace
}  // namespace quicksand
