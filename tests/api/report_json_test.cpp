#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "api/case_json.hpp"

namespace quicksand {
namespace {

using nlohmann::json;

TEST(PlanJson, CarriesTheFieldsOfThePlan) {
  Plan plan;
  plan.cells = {30, 30, 1};
  plan.reasons = {"water is modelled"};
  plan.stages = {{"rest", 0, 2, {"Gates closed: valve."}}};
  plan.soil_points = 7;
  plan.bound = {"soil wave", 1e-4};
  plan.bounds = {{"soil wave", 1e-4}, {"water speed", 2e-3}};
  const json j = json::parse(plan_json(plan));
  EXPECT_EQ(j["cells"], (json{30, 30, 1}));
  EXPECT_EQ(j["soil_points"], 7);
  EXPECT_EQ(j["reasons"][0], "water is modelled");
  EXPECT_EQ(j["stages"][0],
            json::parse(R"({"name":"rest","begin":0,"end":2,"does":["Gates closed: valve."]})"));
  EXPECT_EQ(j["bound"]["name"], "soil wave");
  EXPECT_EQ(j["bounds"][1]["seconds"], 2e-3);
}

TEST(ReportJson, CarriesStatusLedgerAndHeadline) {
  Scene scene;
  scene.name = "Heave";
  RunReport report;
  report.ledger.water_mass = 12.5;
  report.ledger.impulse_walls = {1, 2, 0};
  report.heave.push_back({});
  report.heave[0].moved = true;
  report.heave[0].gradient = 1.92;
  report.steps_bound_by = {{"soil wave", 2.5}};
  report.phases = {{"pressure", 0.25}};
  const json j = json::parse(report_json(scene, Plan{}, report));
  EXPECT_EQ(j["name"], "Heave");
  EXPECT_EQ(j["status"], "succeeded");
  EXPECT_EQ(j["failure"], nullptr);
  EXPECT_EQ(j["headline"]["moved"], true);
  EXPECT_EQ(j["headline"]["gradient"], 1.92);
  EXPECT_EQ(j["ledger"]["water_mass"], 12.5);
  EXPECT_EQ(j["ledger"]["impulse_walls"], (json{1, 2, 0}));
  EXPECT_EQ(j["steps_bound_by"][0]["name"], "soil wave");
  EXPECT_EQ(j["phases"][0]["seconds"], 0.25);
  EXPECT_EQ(j["plan"]["dimensions"], 2);
}

TEST(ReportJson, CarriesFailuresEvenWithNumbersThatAreNone) {
  RunReport report;
  report.status = RunStatus::failed;
  report.failure = {"diverged", "a velocity is not a number", 0.25, {1, 2, 0}};
  report.ledger.energy_kinetic = std::nan("");
  const json j = json::parse(report_json(Scene{}, Plan{}, report));
  EXPECT_EQ(j["status"], "failed");
  EXPECT_EQ(j["failure"]["code"], "diverged");
  EXPECT_EQ(j["failure"]["place"], (json{1, 2, 0}));
  EXPECT_EQ(j["ledger"]["energy_kinetic"], nullptr);
  EXPECT_EQ(j["headline"], nullptr);
}

}  // namespace
}  // namespace quicksand
