// What a case would cost, with all presets side by side.

#include <nlohmann/json.hpp>

#include "api/case_json.hpp"

namespace quicksand {
namespace {

using Json = nlohmann::ordered_json;

Json cost_json(const char* name, const std::string& case_text, Preset preset, const Calibration& machine,
               const std::optional<Trial>& trial) {
  const ParsedCase parsed = parse_case(case_text, preset, machine);
  if (!parsed.scene)
    return {{"preset", name}, {"fault", parsed.faults.front().pointer + ": " + parsed.faults.front().detail}};
  Plan plan = make_plan(*parsed.scene, machine);
  if (trial) foretell(*trial, *parsed.scene, machine, plan);
  return {{"preset", name},
          {"fault", nullptr},
          {"cell_size", plan.cell_size},
          {"points", plan.soil_points + plan.fixed_soil_points + plan.water_points},
          {"memory_bytes", plan.memory_bytes},
          {"time_step", plan.time_step},
          {"bound", plan.bound.name},
          {"steps", plan.steps},
          {"seconds", plan.seconds},
          {"expected_error", plan.expected_error}};
}

}  // namespace

std::string estimate_json(const std::string& case_text, const Plan& plan, const Calibration& machine,
                          const std::optional<Trial>& trial) {
  Json json = Json::parse(plan_json(plan));
  json["presets"] = Json::array();
  for (const auto& [preset, name] :
       {std::pair{Preset::draft, "draft"}, {Preset::standard, "standard"}, {Preset::fine, "fine"}})
    json["presets"].push_back(cost_json(name, case_text, preset, machine, trial));
  return json.dump(2) + "\n";
}

}  // namespace quicksand
