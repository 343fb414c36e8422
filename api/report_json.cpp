// Plan and report as JSON: the field names of the structs.

#include <nlohmann/json.hpp>

#include "api/case_json.hpp"

namespace quicksand {
namespace {

using Json = nlohmann::ordered_json;

Json bounds_json(const std::vector<StepBound>& bounds) {
  Json list = Json::array();
  for (const StepBound& bound : bounds) list.push_back({{"name", bound.name}, {"seconds", bound.seconds}});
  return list;
}

Json stages_json(const std::vector<StagePlan>& stages) {
  Json list = Json::array();
  for (const StagePlan& stage : stages)
    list.push_back({{"name", stage.name}, {"begin", stage.begin}, {"end", stage.end}, {"does", stage.does}});
  return list;
}

Json to_json(const std::optional<TrialFigures>& trial) {
  if (!trial) return nullptr;
  return {{"cell_size", trial->cell_size},
          {"steps", trial->steps},
          {"seconds", trial->seconds},
          {"fraction", trial->fraction}};
}

Json to_json(const Plan& p) {
  return {{"dimensions", p.dimensions},
          {"cells", p.cells},
          {"cell_size", p.cell_size},
          {"has_soil", p.has_soil},
          {"has_water", p.has_water},
          {"has_viscosity", p.has_viscosity},
          {"reasons", p.reasons},
          {"stages", stages_json(p.stages)},
          {"soil_points", p.soil_points},
          {"fixed_soil_points", p.fixed_soil_points},
          {"water_points", p.water_points},
          {"memory_bytes", p.memory_bytes},
          {"time_step", p.time_step},
          {"bound", {{"name", p.bound.name}, {"seconds", p.bound.seconds}}},
          {"bounds", bounds_json(p.bounds)},
          {"end_time", p.end_time},
          {"steps", p.steps},
          {"seconds", p.seconds},
          {"trial", to_json(p.trial)},
          {"error_class", word_of(p.kind)},
          {"expected_error", p.expected_error}};
}

Json to_json(const Ledger& l) {
  return {{"water_mass_initial", l.water_mass_initial},
          {"water_mass", l.water_mass},
          {"solid_mass_initial", l.solid_mass_initial},
          {"solid_mass", l.solid_mass},
          {"water_in", l.water_in},
          {"water_out", l.water_out},
          {"soil_out", l.soil_out},
          {"water_removed", l.water_removed},
          {"soil_removed", l.soil_removed},
          {"water_volume_initial", l.water_volume_initial},
          {"water_volume", l.water_volume},
          {"water_volume_drift_max", l.water_volume_drift_max},
          {"water_volume_drift", l.water_volume_drift},
          {"momentum_change", l.momentum_change},
          {"impulse_gravity", l.impulse_gravity},
          {"impulse_walls", l.impulse_walls},
          {"impulse_surface", l.impulse_surface},
          {"impulse_loads", l.impulse_loads},
          {"impulse_flow", l.impulse_flow},
          {"impulse_stages", l.impulse_stages},
          {"impulse_damping", l.impulse_damping},
          {"impulse_removed", l.impulse_removed},
          {"momentum_residual", l.momentum_residual},
          {"energy_kinetic", l.energy_kinetic},
          {"energy_potential", l.energy_potential},
          {"energy_strain", l.energy_strain},
          {"energy_damped", l.energy_damped},
          {"clipped_points", l.clipped_points},
          {"clamped_values", l.clamped_values},
          {"deleted_points", l.deleted_points},
          {"cut_steps", l.cut_steps},
          {"retries", l.retries}};
}

Json to_json(const HeaveReport& h) {
  return {{"moved", h.moved},
          {"time", h.time},
          {"head_difference", h.head_difference},
          {"gradient", h.gradient},
          {"critical_gradient", h.critical_gradient},
          {"final_rise", h.final_rise},
          {"max_rise", h.max_rise},
          {"max_point_displacement", h.max_point_displacement}};
}

Json to_json(const QuasiStaticReport& q) {
  return {{"stage", q.stage},
          {"inertia", q.inertia},
          {"process_time", q.process_time},
          {"transit_time", q.transit_time},
          {"inertia_ratio", q.inertia_ratio},
          {"negligible", q.negligible}};
}

const char* word_of(RunStatus status) {
  switch (status) {
    case RunStatus::succeeded:
      return "succeeded";
    case RunStatus::failed:
      return "failed";
    case RunStatus::suspended:
      return "suspended";
    case RunStatus::canceled:
      return "canceled";
  }
  return "";
}

const char* word_of(OrderBasis basis) {
  switch (basis) {
    case OrderBasis::assumed:
      return "assumed";
    case OrderBasis::observed:
      return "observed";
    case OrderBasis::not_asymptotic:
      return "not in the asymptotic range";
  }
  return "";
}

Json to_json(const DiscretisationError& e) {
  return {{"error", e.error}, {"order", e.order}, {"basis", word_of(e.basis)}};
}

Json to_json(const ErrorEstimateReport& estimate) {
  Json runs = Json::array(), figures = Json::array();
  for (const CompanionRun& c : estimate.companions)
    runs.push_back({{"cell_size", c.cell_size},
                    {"ratio", c.ratio},
                    {"status", word_of(c.status)},
                    {"failure", c.failure.empty() ? Json(nullptr) : Json(c.failure)},
                    {"steps", c.steps},
                    {"wall_seconds", c.wall_seconds}});
  for (const FigureError& f : estimate.figures)
    figures.push_back({{"name", f.name},
                       {"component", f.component},
                       {"unit", f.unit},
                       {"value", f.value},
                       {"range", f.range},
                       {"end", to_json(f.end)},
                       {"history", to_json(f.history)}});
  return {{"missing", estimate.missing.empty() ? Json(nullptr) : Json(estimate.missing)},
          {"companions", runs},
          {"figures", figures}};
}

}  // namespace

std::string plan_json(const Plan& plan) { return to_json(plan).dump(2) + "\n"; }

std::string report_json(const Scene& scene, const Plan& plan, const RunReport& report,
                        const std::optional<ErrorEstimateReport>& error_estimate) {
  Json json{{"name", scene.name}, {"status", word_of(report.status)}, {"failure", nullptr}};
  if (report.status == RunStatus::failed)
    json["failure"] = {{"code", report.failure.code},
                       {"message", report.failure.message},
                       {"time", report.failure.time},
                       {"place", report.failure.place}};
  json["cautions"] = report.cautions;
  json["headline"] = report.heave.empty() ? Json(nullptr) : to_json(report.heave.front());
  json["error_estimate"] = error_estimate ? to_json(*error_estimate) : Json(nullptr);
  json["quasi_static"] = Json::array();
  for (const QuasiStaticReport& stage : report.quasi_static) json["quasi_static"].push_back(to_json(stage));
  json["sim_time"] = report.sim_time;
  json["wall_seconds"] = report.wall_seconds;
  json["point_steps"] = report.point_steps;
  json["steps"] = report.steps;
  json["time_step_min"] = report.time_step_min;
  json["time_step_max"] = report.time_step_max;
  json["steps_bound_by"] = bounds_json(report.steps_bound_by);
  json["pressure_iterations_mean"] = report.pressure_iterations_mean;
  json["frames"] = report.frames;
  json["phases"] = Json::array();
  for (const PhaseTime& phase : report.phases)
    json["phases"].push_back({{"name", phase.name}, {"seconds", phase.seconds}});
  json["ledger"] = to_json(report.ledger);
  json["plan"] = to_json(plan);
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace quicksand
