#include "api/scene_from_json.hpp"

#include "engine/scene/preset.hpp"

namespace quicksand {
namespace {

void read_domain(const Place& place, Reading& reading, Domain& domain) {
  place["dimension"].read(domain.dimension);
  if (!place["dimension"].refused()) reading.dimensions = domain.dimension == Dimension::space ? 3 : 2;
  place["min"].read(domain.min);
  place["max"].read(domain.max);
  place["cell_size"].read(domain.cell_size);
  for (std::size_t k = 0; k < side_words.size(); ++k) {
    place["sides"][side_words[k]]["kind"].read(domain.sides[k].kind);
  }
}

void read_soil(const Place& place, Soil& soil) {
  place["grain_density"].read(soil.grain_density);
  place["porosity"].read(soil.porosity);
  place["max_porosity"].read(soil.max_porosity);
  place["k0"].read(soil.k0);
  const Place permeability = place["permeability"];
  permeability["law"].read(soil.permeability.law);
  permeability["value"].read(soil.permeability.value);
  permeability["exponent"].read(soil.permeability.exponent);
  permeability["grain_size"].read(soil.permeability.grain_size);
  const Place model = place["model"];
  model["law"].read(soil.model.law);
  model["young_modulus"].read(soil.model.young_modulus);
  model["poisson_ratio"].read(soil.model.poisson_ratio);
  model["friction_angle"].read(soil.model.friction_angle);
  model["dilation_angle"].read(soil.model.dilation_angle);
  model["cohesion"].read(soil.model.cohesion);
  model["tension_cutoff"].read(soil.model.tension_cutoff);
  model["residual_cohesion"].read(soil.model.residual_cohesion);
  model["softening_strain"].read(soil.model.softening_strain);
  model["compression_slope"].read(soil.model.compression_slope);
  model["swelling_slope"].read(soil.model.swelling_slope);
  model["critical_state_slope"].read(soil.model.critical_state_slope);
  model["over_consolidation_ratio"].read(soil.model.over_consolidation_ratio);
}

void read_materials(const Place& place, Scene& scene) {
  for (const auto& [name, soil] : place["soils"].items()) read_soil(soil, scene.soils[name]);
  const Place water = place["water"];
  water["density"].read(scene.water.density);
  water["viscosity"].read(scene.water.viscosity);
  std::string word;
  water["bulk_modulus"].read(word);
  if (word == "incompressible") scene.water.bulk_modulus.reset();
  water["bulk_modulus"].read(scene.water.bulk_modulus);
}

void read(const Place& place, Body& body) {
  place["name"].read(body.name);
  place["kind"].read(body.kind);
  place["soil"].read(body.soil);
  place["region"].read(body.region);
  place["fixed"].read(body.fixed);
  place["velocity"].read(body.velocity);
  place["rotation_rate"].read(body.rotation_rate);
}

void read(const Place& place, Wall& wall) {
  place["name"].read(wall.name);
  if (const Place block = place["block"]; block.given()) block.read(wall.block.emplace());
  if (const Place line = place["line"]; line.given()) line.read(wall.line.emplace());
  place["no_slip"].read(wall.no_slip);
}

void read(const Place& place, Gate& gate) {
  place["name"].read(gate.name);
  place["line"].read(gate.line);
}

void read(const Place& place, Reservoir& reservoir) {
  place["name"].read(reservoir.name);
  place["line"].read(reservoir.line);
  place["head"].read(reservoir.head);
}

void read(const Place& place, Load& load) {
  place["name"].read(load.name);
  place["kind"].read(load.kind);
  place["body"].read(load.body);
  place["side"].read(load.side);
  place["traction"].read(load.traction);
  place["ramp"].read(load.ramp);
  place["plate"].read(load.plate);
  place["plate_velocity"].read(load.plate_velocity);
  if (const Place force = place["plate_force"]; force.given()) force.read(load.plate_force.emplace());
  place["rough"].read(load.rough);
}

void read(const Place& place, Stage& stage) {
  place["name"].read(stage.name);
  place["duration"].read(stage.duration);
  if (const Place rest = place["until_rest"]; rest.given()) {
    rest["speed"].read(stage.until_rest.emplace().speed);
    rest["at_least"].read(stage.until_rest->at_least);
  }
  place["open_gates"].read(stage.open_gates);
  for (const auto& [name, head] : place["heads"].items()) head.read(stage.heads[name]);
  place["heads_ramp"].read(stage.heads_ramp);
  if (const Place loads = place["loads"]; loads.is_list()) loads.read(stage.loads.emplace());
  place["remove_bodies"].read(stage.remove_bodies);
  place["damping"].read(stage.damping);
  place["quasi_static"].read(stage.quasi_static);
}

void read(const Place& place, Probe& probe) {
  place["name"].read(probe.name);
  place["at"].read(probe.at);
  place["quantity"].read(probe.quantity);
}

void read(const Place& place, Section& section) {
  place["name"].read(section.name);
  place["line"].read(section.line);
  place["quantity"].read(section.quantity);
}

template <typename Item>
void read_list(const Place& place, std::vector<Item>& list) {
  for (const auto& [index, item] : place.items()) read(item, list.emplace_back());
}

void read_initial(const Place& place, Initial& initial) {
  place["pressure"].read(initial.pressure);
  place["water_table"].read(initial.water_table);
  place["uniform_pressure"].read(initial.uniform_pressure);
  place["stress"].read(initial.stress);
  place["k0"].read(initial.k0);
  const Place stress = place["uniform_stress"];
  const auto components = stress.items();
  const std::size_t expected = stress.reading().dimensions == 3 ? 6 : 4;
  if (stress.given() && stress.reading().dimensions != 0 && components.size() != expected)
    return stress.reading().refuse(stress.pointer(), "a list of " + std::to_string(components.size()) +
                                                         " is not allowed: give " + std::to_string(expected) +
                                                         " numbers, as domain.dimension asks");
  for (std::size_t k = 0; k < components.size(); ++k) components[k].second.read(initial.uniform_stress[k]);
}

void read_output(const Place& place, Output& output) {
  place["frame_interval"].read(output.frame_interval);
  place["series_interval"].read(output.series_interval);
  place["fields"].read(output.fields);
  read_list(place["probes"], output.probes);
  read_list(place["sections"], output.sections);
  if (const Place heave = place["heave"]; heave.given()) {
    HeaveWatch& watch = output.heave.emplace();
    heave["body"].read(watch.body);
    heave["threshold"].read(watch.threshold);
    heave["below"].read(watch.below);
    heave["above"].read(watch.above);
  }
}

void read_error_estimate(const Place& place, ErrorEstimate& estimate) {
  bool wanted = false;
  std::string word;
  place.read(wanted);
  place.read(word);
  if (wanted) estimate = ErrorEstimate::coarser;
  if (word == "finer") estimate = ErrorEstimate::finer;
}

void read_numerics(const Place& place, const std::optional<Preset>& preset, Numerics& numerics) {
  place["preset"].read(numerics.preset);
  apply_preset(preset.value_or(numerics.preset), numerics);
  place["cell_size_factor"].read(numerics.cell_size_factor);
  place["points_per_cell"].read(numerics.points_per_cell);
  place["kernel"].read(numerics.kernel);
  place["transfer"].read(numerics.transfer);
  place["pic_rate"].read(numerics.pic_rate);
  place["pressure"].read(numerics.pressure);
  place["pressure_tolerance"].read(numerics.pressure_tolerance);
  place["time_step"].read(numerics.time_step);
  place["time_step_factor"].read(numerics.time_step_factor);
  place["drift_time"].read(numerics.drift_time);
  place["quasi_static_transits"].read(numerics.quasi_static_transits);
  place["max_steps"].read(numerics.max_steps);
  read_error_estimate(place["error_estimate"], numerics.error_estimate);
  place["target_error"].read(numerics.target_error);
  place["budget_seconds"].read(numerics.budget_seconds);
  place["chosen"].read(numerics.chosen);
}

/// True when the grid itself cannot be trusted, so that no geometry can be checked against it.
bool grid_broken(const Place& root) {
  for (const char* key : {"dimension", "min", "max", "cell_size"})
    if (root["domain"][key].broken()) return true;
  for (const char* key : {"preset", "cell_size_factor", "points_per_cell"})
    if (root["numerics"][key].refused()) return true;
  return root["domain"].refused() || root["numerics"].refused();
}

}  // namespace

Scene scene_from_json(const nlohmann::json& document, const std::optional<Preset>& preset, Reading& reading) {
  const Place root(document, reading);
  Scene scene;
  root["name"].read(scene.name);
  root["description"].read(scene.description);
  read_domain(root["domain"], reading, scene.domain);
  root["gravity"].read(scene.gravity);
  read_materials(root["materials"], scene);
  read_list(root["bodies"], scene.bodies);
  read_list(root["walls"], scene.walls);
  read_list(root["gates"], scene.gates);
  read_list(root["reservoirs"], scene.reservoirs);
  read_initial(root["initial"], scene.initial);
  read_list(root["loads"], scene.loads);
  read_list(root["stages"], scene.stages);
  read_output(root["output"], scene.output);
  read_numerics(root["numerics"], preset, scene.numerics);
  if (grid_broken(root)) scene.domain.cell_size = 0;
  return scene;
}

}  // namespace quicksand
