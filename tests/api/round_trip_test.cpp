#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/api/case_faults.hpp"

namespace quicksand {
namespace {

using nlohmann::json;
using test::patched;

Scene sound(const std::string& text, const std::optional<Preset>& preset = {}) {
  ParsedCase parsed = parse_case(text, preset);
  EXPECT_TRUE(parsed.scene.has_value()) << test::said(parsed.faults);
  return parsed.scene.value_or(Scene{});
}

TEST(RoundTrip, ResolvedCaseIsAFixedPoint) {
  const char* variants[] = {
      "[]",
      R"([{"op":"add","path":"/materials/water/bulk_modulus","value":"incompressible"}])",
      R"([{"op":"add","path":"/numerics/time_step","value":1.0000000000000001e-4}])",
      R"([{"op":"remove","path":"/numerics/preset"},{"op":"add","path":"/numerics/target_error","value":0.1}])",
      R"([{"op":"remove","path":"/numerics/preset"},{"op":"add","path":"/numerics/budget_seconds","value":1e6}])",
      R"([{"op":"replace","path":"/initial","value":{"pressure":"uniform","uniform_pressure":12.5,"stress":"uniform","uniform_stress":[-1,-2,-3,0]}}])",
      R"([{"op":"replace","path":"/initial","value":{"stress":"zero"}}])",
      R"([{"op":"replace","path":"/bodies/4/region","value":{"disc":{"center":[0.45,0.4],"radius":0.1}}}])",
      R"([{"op":"replace","path":"/stages/0/loads","value":null}])",
      // Only water: keys of soil have no effect and must not be written.
      R"([{"op":"replace","path":"/bodies","value":[{"name":"w","kind":"water","region":{"box":{"min":[0,0],"max":[0.2,0.2]}},"velocity":[1,0]}]},
          {"op":"remove","path":"/materials/soils"},{"op":"remove","path":"/initial"},{"op":"remove","path":"/loads"},
          {"op":"remove","path":"/stages/0/loads"},{"op":"remove","path":"/output/heave"}])",
      // Only dry soil: keys of water.
      R"([{"op":"replace","path":"/bodies","value":[{"name":"sand","kind":"soil","soil":"sand","region":{"box":{"min":[0,0],"max":[0.2,0.2]}}}]},
          {"op":"remove","path":"/materials/soils/plate"},{"op":"remove","path":"/materials/soils/sand/permeability"},
          {"op":"remove","path":"/materials/water"},{"op":"remove","path":"/output"},{"op":"remove","path":"/numerics/pressure_tolerance"}])",
  };
  for (const char* variant : variants) {
    const std::string once = resolved_case(sound(patched(variant)));
    EXPECT_EQ(resolved_case(sound(once)), once) << variant;
  }
}

TEST(RoundTrip, ResolvedCaseWritesDefaultsAndPresetChoices) {
  const json resolved = json::parse(resolved_case(sound(test::heave_case())));
  EXPECT_EQ(resolved["numerics"]["cell_size_factor"], 2);
  EXPECT_EQ(resolved["numerics"]["pic_rate"], 5);
  EXPECT_EQ(resolved["numerics"]["time_step"], nullptr);
  EXPECT_EQ(resolved["domain"]["min"], (json{0, 0}));
  EXPECT_EQ(resolved["domain"]["sides"]["top"]["kind"], "slip");
  EXPECT_EQ(resolved["materials"]["water"]["viscosity"], 1e-3);
  EXPECT_EQ(resolved["materials"]["soils"]["plate"]["porosity"], 0.4);
  EXPECT_EQ(resolved["materials"]["soils"]["sand"]["permeability"]["law"], "kozeny_carman");
  EXPECT_EQ(resolved["output"]["series_interval"], 0.01);
  EXPECT_EQ(resolved["output"]["heave"]["threshold"], 5e-4);
  EXPECT_EQ(resolved["stages"][1]["loads"], nullptr);
}

TEST(RoundTrip, ScenesHoldWhatTheCaseSays) {
  const Scene scene = sound(test::heave_case());
  EXPECT_EQ(scene.name, "Heave");
  EXPECT_EQ(scene.domain.sides[2].kind, SideKind::no_slip);
  EXPECT_EQ(scene.domain.sides[0].kind, SideKind::slip);
  EXPECT_EQ(scene.soils.at("sand").permeability.value, 1e-4);
  EXPECT_EQ(scene.soils.at("sand").max_porosity, 0.5);
  EXPECT_EQ(scene.water.bulk_modulus, 2e7);
  ASSERT_EQ(scene.bodies.size(), 5u);
  EXPECT_EQ(scene.bodies[1].region.kind, Region::Kind::difference);
  EXPECT_TRUE(scene.bodies[2].fixed);
  EXPECT_EQ(scene.bodies[3].region.vertices[2], (std::array<double, 2>{0.6, 0.24}));
  EXPECT_EQ(scene.walls[0].block->max[0], 0.3);
  EXPECT_TRUE(scene.walls[1].no_slip);
  EXPECT_EQ(scene.gates[0].line.to[1], 0.08);
  EXPECT_EQ(scene.stages[0].loads, std::vector<std::string>{});
  EXPECT_FALSE(scene.stages[1].loads.has_value());
  EXPECT_EQ(scene.stages[1].open_gates, std::vector<std::string>{"valve"});
  EXPECT_EQ(scene.output.probes[1].at[1], 0.24);
  EXPECT_EQ(scene.output.heave->below, "below");
}

TEST(Presets, ExplicitKeysWinOverThePreset) {
  const Scene draft = sound(test::heave_case());
  EXPECT_EQ(draft.numerics.cell_size_factor, 2);
  EXPECT_EQ(draft.cell_size(), 0.02);
  EXPECT_EQ(draft.numerics.pressure_tolerance, 1e-8);  // explicit
  const std::string plain = patched(R"([{"op":"remove","path":"/numerics/pressure_tolerance"}])");
  EXPECT_EQ(sound(plain).numerics.pressure_tolerance, 1e-5);
  EXPECT_EQ(sound(plain, Preset::standard).numerics.pressure_tolerance, 1e-6);
  EXPECT_EQ(sound(plain, Preset::fine).numerics.pressure_tolerance, 1e-7);
}

constexpr const char* kTarget =
    R"([{"op":"remove","path":"/numerics/preset"},{"op":"add","path":"/numerics/target_error","value":0.04}])";

TEST(TargetError, ChoosesCellsAndSaysWhy) {
  const Scene scene = sound(patched(kTarget));
  EXPECT_EQ(scene.cell_size(), 0.01);  // 0.065 in draft, 0.035 in standard; nothing between fits the walls
  EXPECT_EQ(scene.numerics.preset, Preset::standard);
  EXPECT_EQ(scene.numerics.pressure_tolerance, 1e-8);  // explicit
  const json numerics = json::parse(resolved_case(scene))["numerics"];
  EXPECT_EQ(numerics["target_error"], 0.04);
  EXPECT_EQ(numerics["cell_size_factor"], 1);
  EXPECT_NE(numerics["chosen"].get<std::string>().find("0.04"), std::string::npos);
}

TEST(TargetError, WhatWasChosenIsNotChosenAgain) {
  json chosen = json::parse(resolved_case(sound(patched(kTarget))));
  chosen["numerics"]["cell_size_factor"] = 2;  // whatever it is, it stays
  EXPECT_EQ(sound(chosen.dump()).cell_size(), 0.02);
}

TEST(TargetError, AnAskedForPresetReplacesIt) {
  const Scene scene = sound(patched(kTarget), Preset::draft);
  EXPECT_EQ(scene.cell_size(), 0.02);
  EXPECT_FALSE(scene.numerics.target_error);
  EXPECT_EQ(scene.numerics.chosen, "");
}

TEST(Budget, CountsByTheMachinesSpeed) {
  const std::string text = patched(
      R"([{"op":"remove","path":"/numerics/preset"},{"op":"add","path":"/numerics/budget_seconds","value":1000}])");
  Calibration slow;
  for (StepCost& cost : slow.cost) cost.step *= 30, cost.point *= 30;
  const ParsedCase here = parse_case(text), there = parse_case(text, {}, slow);
  ASSERT_TRUE(here.scene && there.scene) << test::said(there.faults);
  EXPECT_LT(here.scene->cell_size(), there.scene->cell_size());
  EXPECT_LE(make_plan(*here.scene).seconds, 1000);
  EXPECT_LE(make_plan(*there.scene, slow).seconds, 1000);
}

TEST(Presets, AnAskedForPresetReplacesTheCases) {
  const Scene fine = sound(test::heave_case(), Preset::fine);
  EXPECT_EQ(fine.numerics.preset, Preset::fine);
  EXPECT_EQ(fine.cell_size(), 0.005);
  EXPECT_EQ(fine.numerics.pressure_tolerance, 1e-8);  // still explicit
  const std::string factor = patched(R"([{"op":"add","path":"/numerics/cell_size_factor","value":1}])");
  EXPECT_EQ(sound(factor, Preset::fine).cell_size(), 0.01);
}

TEST(Presets, WithoutAnyTheStandardIsMeant) {
  const Scene scene = sound(patched(R"([{"op":"remove","path":"/numerics"}])"));
  EXPECT_EQ(scene.numerics.preset, Preset::standard);
  EXPECT_EQ(scene.cell_size(), 0.01);
  EXPECT_EQ(scene.numerics.pressure_tolerance, 1e-6);
}

}  // namespace
}  // namespace quicksand
