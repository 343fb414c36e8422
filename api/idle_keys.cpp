#include "api/idle_keys.hpp"

#include <initializer_list>

#include "engine/scene/stages.hpp"

namespace quicksand {
namespace {

using Keys = std::initializer_list<const char*>;

void idle(const Place& place, Keys keys, const std::string& why) {
  for (const char* key : keys)
    if (const Place given = place[key]; given.given())
      given.reading().refuse(given.pointer(), "has no effect " + why + ": remove it");
}

void needed(const Place& place, Keys keys, const std::string& why) {
  for (const char* key : keys)
    if (const Place absent = place[key]; !absent.given() && !absent.refused())
      absent.reading().refuse(absent.pointer(), "is missing: needed " + why);
}

/// "with kind traction"
template <typename Choice>
std::string with(const char* key, Choice choice) {
  return std::string("with ") + key + " " + word_of(choice);
}

void check_sides(const Place& sides, const Domain& domain) {
  if (domain.dimension != Dimension::space) idle(sides, {"front", "back"}, "in the plane");
}

void check_permeability(const Place& soil, PermeabilityLaw law, bool water) {
  const Place place = soil["permeability"];
  if (!water) return idle(soil, {"permeability"}, "in a scene without water");
  needed(soil, {"permeability"}, "in a scene with water");
  if (!place.given() || place["law"].refused()) return;
  const bool ergun = law == PermeabilityLaw::ergun;
  needed(place, {ergun ? "grain_size" : "value"}, with("law", law));
  idle(place, {ergun ? "value" : "grain_size"}, with("law", law));
  if (law != PermeabilityLaw::power) idle(place, {"exponent"}, with("law", law));
}

void check_model(const Place& place, const SoilModel& model) {
  if (!place.given() || place["law"].refused()) return;
  static constexpr Keys stiffness{"young_modulus"},
      slopes{"compression_slope", "swelling_slope", "critical_state_slope"};
  static constexpr Keys cone{"friction_angle", "dilation_angle",    "cohesion",
                             "tension_cutoff", "residual_cohesion", "softening_strain"};
  const std::string why = with("law", model.law);
  const bool cam_clay = model.law == SoilLaw::modified_cam_clay;
  needed(place, cam_clay ? slopes : stiffness, why);
  idle(place, cam_clay ? stiffness : slopes, why);
  if (!cam_clay) idle(place, {"over_consolidation_ratio"}, why);
  if (model.law != SoilLaw::mohr_coulomb) return idle(place, cone, why);
  needed(place, {"friction_angle"}, why);
  if (place["residual_cohesion"].refused()) return;
  if (model.residual_cohesion)
    needed(place, {"softening_strain"}, "with residual_cohesion");
  else
    idle(place, {"softening_strain"}, "without residual_cohesion");
}

void check_body(const Place& place, const Body& body) {
  if (place["kind"].refused()) return;
  if (body.kind == BodyKind::water) return idle(place, {"soil", "fixed"}, with("kind", body.kind));
  needed(place, {"soil"}, with("kind", body.kind));
  if (body.fixed) idle(place, {"velocity", "rotation_rate"}, "on a fixed body");
}

void check_initial(const Place& place, const Initial& initial, bool water, bool soil) {
  if (!water) idle(place, {"pressure", "water_table", "uniform_pressure"}, "in a scene without water");
  if (!soil) idle(place, {"stress", "k0", "uniform_stress"}, "in a scene without soil");
  if (water && !place["pressure"].refused()) {
    const std::string why = with("pressure", initial.pressure);
    if (initial.pressure != InitialPressure::hydrostatic) idle(place, {"water_table"}, why);
    if (initial.pressure != InitialPressure::uniform)
      idle(place, {"uniform_pressure"}, why);
    else
      needed(place, {"uniform_pressure"}, why);
  }
  if (soil && !place["stress"].refused()) {
    const std::string why = with("stress", initial.stress);
    if (initial.stress != InitialStress::k0) idle(place, {"k0"}, why);
    if (initial.stress != InitialStress::uniform)
      idle(place, {"uniform_stress"}, why);
    else
      needed(place, {"uniform_stress"}, why);
  }
}

void check_load(const Place& place, const Load& load) {
  if (place["kind"].refused()) return;
  const std::string why = with("kind", load.kind);
  if (load.kind == Load::Kind::traction) {
    needed(place, {"traction"}, why);
    return idle(place, {"plate", "plate_velocity", "plate_force", "rough"}, why);
  }
  needed(place, {"plate"}, why);
  idle(place, {"side", "traction"}, why);
  if (load.plate_force)
    idle(place, {"plate_velocity"}, "with plate_force");
  else
    needed(place, {"plate_velocity"}, "without plate_force");
}

void check_stage(const Place& place, const Stage& stage, bool soil) {
  if (!soil) idle(place, {"quasi_static"}, "in a scene without soil");
  if (stage.heads.empty() && !place["heads"].broken()) idle(place, {"heads_ramp"}, "without heads");
}

void check_numerics(const Place& place, const Scene& scene, bool water) {
  const Numerics& numerics = scene.numerics;
  if (!has_quasi_static(scene)) idle(place, {"quasi_static_transits"}, "without a quasi_static stage");
  if (numerics.transfer != Transfer::flip) idle(place, {"pic_rate"}, with("transfer", numerics.transfer));
  if (numerics.time_step) idle(place, {"time_step_factor"}, "with a fixed time_step");
  if (!numerics.target_error && !numerics.budget_seconds) {
    if (!numerics.chosen.empty()) idle(place, {"chosen"}, "without target_error or budget_seconds");
  } else if (numerics.chosen.empty()) {
    idle(place, {"preset", "cell_size_factor"},
         std::string("with ") + (numerics.target_error ? "target_error" : "budget_seconds"));
  }
  if (!water)
    return idle(place, {"pressure", "pressure_tolerance", "drift_time"}, "in a scene without water");
  if (numerics.pressure != PressureScheme::implicit)
    idle(place, {"pressure_tolerance"}, with("pressure", numerics.pressure));
}

}  // namespace

void check_choices(const nlohmann::json& document, const Scene& scene, Reading& reading) {
  const Place root(document, reading);
  const bool water = has_water(scene), soil = has_soil(scene);
  check_sides(root["domain"]["sides"], scene.domain);
  for (const auto& [name, place] : root["materials"]["soils"].items()) {
    if (!place.given()) continue;
    if (scene.initial.stress != InitialStress::k0)
      idle(place, {"k0"}, "with initial.stress " + std::string(word_of(scene.initial.stress)));
    check_permeability(place, scene.soils.at(name).permeability.law, water);
    check_model(place["model"], scene.soils.at(name).model);
  }
  if (!water) idle(root["materials"], {"water"}, "in a scene without water");
  const auto bodies = root["bodies"].items();
  for (std::size_t k = 0; k < bodies.size(); ++k) check_body(bodies[k].second, scene.bodies[k]);
  check_initial(root["initial"], scene.initial, water, soil);
  const auto loads = root["loads"].items();
  for (std::size_t k = 0; k < loads.size(); ++k) check_load(loads[k].second, scene.loads[k]);
  const auto stages = root["stages"].items();
  for (std::size_t k = 0; k < stages.size(); ++k) check_stage(stages[k].second, scene.stages[k], soil);
  check_numerics(root["numerics"], scene, water);
}

}  // namespace quicksand
