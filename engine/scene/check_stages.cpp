// Loads, stages and output: times, and the names they refer to.

#include <algorithm>
#include <set>

#include "engine/scene/check_parts.hpp"

namespace quicksand {
namespace {

/// Most frames and samples that one run may store.
constexpr double max_frames = 1e5, max_samples = 1e7;

template <typename Items>
auto find_named(const Items& items, const std::string& name) {
  return std::find_if(items.begin(), items.end(), [&](const auto& item) { return item.name == name; });
}

template <typename Items>
bool has_name(const Items& items, const std::string& name) {
  return find_named(items, name) != items.end();
}

/// Names that a stage lists: each must exist, and occur once.
template <typename Items>
void check_references(const std::vector<std::string>& names, const Items& items, const std::string& pointer,
                      const std::string& what, Faults& faults) {
  std::set<std::string> seen;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::string place = pointer + "/" + std::to_string(k);
    if (!has_name(items, names[k]))
      faults.push_back({place, there_is_no(what, names[k], items)});
    else if (!seen.insert(names[k]).second)
      faults.push_back({place, "\"" + names[k] + "\" is listed twice"});
  }
}

/// Heads and bodies: what a stage changes for itself and those after it.
void check_changes(const Scene& scene, std::size_t index, Faults& faults) {
  const Stage& stage = scene.stages[index];
  const auto here = [&](const std::string& rest) { return at_index("stages", index, rest); };
  for (const auto& [name, head] : stage.heads)
    if (!has_name(scene.reservoirs, name))
      faults.push_back({here("/heads/" + escaped(name)), there_is_no("reservoir", name, scene.reservoirs)});
  if (!stage.heads.empty() && stage.heads_ramp > stage.duration)
    faults.push_back({here("/heads_ramp"), text(stage.heads_ramp) + " s is above the duration " +
                                               text(stage.duration) + " s: the heads would not be reached"});
  check_references(stage.remove_bodies, scene.bodies, here("/remove_bodies"), "body", faults);
  for (std::size_t k = 0; k < stage.remove_bodies.size(); ++k)
    if (index > 0 && !present(scene, index - 1, stage.remove_bodies[k]))
      faults.push_back({here("/remove_bodies/" + std::to_string(k)),
                        "\"" + stage.remove_bodies[k] + "\" was removed by an earlier stage"});
  for (std::size_t k = 0; stage.loads && k < stage.loads->size(); ++k)
    if (const auto load = find_named(scene.loads, (*stage.loads)[k]);
        load != scene.loads.end() && !present(scene, index, load->body))
      faults.push_back({here("/loads/" + std::to_string(k)), "\"" + load->name + "\" lies on the body \"" +
                                                                 load->body + "\", which has been removed"});
  const auto still_there = [&](const Body& body) { return present(scene, index, body.name); };
  if (!stage.remove_bodies.empty() && std::none_of(scene.bodies.begin(), scene.bodies.end(), still_there))
    faults.push_back({here("/remove_bodies"), "no body is left: keep one, or end the run before"});
}

void check_stage(const Scene& scene, std::size_t index, Faults& faults) {
  const Stage& stage = scene.stages[index];
  const auto here = [&](const std::string& rest) { return at_index("stages", index, rest); };
  if (!(stage.duration > 0))
    faults.push_back({here("/duration"), text(stage.duration) + " s: give a time above 0"});
  if (stage.until_rest && stage.until_rest->at_least >= stage.duration)
    faults.push_back(
        {here("/until_rest/at_least"), text(stage.until_rest->at_least) + " s is not below the duration " +
                                           text(stage.duration) + " s: the stage could not end at rest"});
  const bool moves = std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& body) {
    return body.kind != BodyKind::water && !body.fixed && present(scene, index, body.name);
  });
  if (stage.quasi_static && !moves)
    faults.push_back({here("/quasi_static"), "no soil moves in this stage: water alone has no slow process"});
  check_references(stage.open_gates, scene.gates, here("/open_gates"), "gate", faults);
  if (stage.loads) check_references(*stage.loads, scene.loads, here("/loads"), "load", faults);
  check_changes(scene, index, faults);
}

void check_gate_uses(const Scene& scene, Faults& faults) {
  for (std::size_t k = 0; k < scene.gates.size(); ++k) {
    const auto open = std::count_if(scene.stages.begin(), scene.stages.end(), [&](const Stage& stage) {
      return std::count(stage.open_gates.begin(), stage.open_gates.end(), scene.gates[k].name) > 0;
    });
    if (open == 0)
      faults.push_back(
          {at_index("gates", k), "no stage opens this gate: make it a wall, or name it in open_gates"});
    else if (open == static_cast<std::ptrdiff_t>(scene.stages.size()))
      faults.push_back({at_index("gates", k), "every stage opens this gate: it has no effect; remove it"});
  }
}

/// A plate pushes down and never pulls; only what is rough takes the soil along.
void check_plate_motion(const Scene& scene, std::size_t k, Faults& faults) {
  const Load& load = scene.loads[k];
  const std::string force = at_index("loads", k, "/plate_force"),
                    velocity = at_index("loads", k, "/plate_velocity");
  const auto sideways = [](const Vec3& v) { return v[0] != 0 || v[2] != 0; };
  if (load.plate_force) {
    if (sideways(*load.plate_force))
      faults.push_back({force, "only its vertical part acts: make the others 0"});
    else if ((*load.plate_force)[1] >= 0)
      faults.push_back({force, "does not press down: give a negative y; a plate cannot pull"});
  } else if (sideways(load.plate_velocity)) {
    if (scene.domain.dimension == Dimension::axisymmetric)
      faults.push_back({velocity, "a rigid plate about an axis cannot move along the radius: make x 0"});
    else if (!load.rough)
      faults.push_back(
          {velocity,
           "sideways it has no effect, as the soil slides along a smooth plate: make it rough, or 0"});
  }
}

void check_loads(const Scene& scene, Faults& faults) {
  for (std::size_t k = 0; k < scene.loads.size(); ++k) {
    const Load& load = scene.loads[k];
    const auto body = find_named(scene.bodies, load.body);
    if (body == scene.bodies.end())
      faults.push_back({at_index("loads", k, "/body"), there_is_no("body", load.body, scene.bodies)});
    else if (body->kind == BodyKind::water || body->fixed)
      faults.push_back({at_index("loads", k, "/body"),
                        "\"" + load.body + "\" cannot carry a load: name a body of soil that is not fixed"});
    if (load.kind == Load::Kind::traction && load.traction == Vec3{0, 0, 0})
      faults.push_back({at_index("loads", k, "/traction"), "zero: the load has no effect"});
    if (load.side >= BodySide::front && scene.domain.dimension != Dimension::space)
      faults.push_back({at_index("loads", k, "/side"), "front and back are sides of bodies in space only"});
    if (load.kind == Load::Kind::plate) check_plate_motion(scene, k, faults);
    bool ever = false;
    for (std::size_t stage = 0; stage < scene.stages.size(); ++stage) ever = ever || acts(scene, stage, load);
    if (!ever)
      faults.push_back({at_index("loads", k), "acts in no stage: remove it, or name it in a stage's loads"});
  }
}

/// Whether something in the scene can ever show the quantity of a probe or field.
std::string missing_for(const Scene& scene, const std::string& quantity) {
  static const std::set<std::string> of_water{"pore_pressure", "head", "water_velocity", "flow"};
  static const std::set<std::string> of_soil{"soil_velocity", "porosity", "effective_stress",
                                             "plastic_strain"};
  if (of_water.contains(quantity) && !has_water(scene)) return "there is no water";
  if (of_soil.contains(quantity) && !has_soil(scene)) return "there is no soil";
  if (quantity == "head" && scene.gravity == Vec3{0, 0, 0}) return "head is not defined without gravity";
  return {};
}

/// Probes or sections.
template <typename Items>
void check_quantities(const Scene& scene, const Items& items, const char* list, Faults& faults) {
  for (std::size_t k = 0; k < items.size(); ++k)
    if (const std::string why = missing_for(scene, items[k].quantity); !why.empty())
      faults.push_back({at_index(list, k, "/quantity"), items[k].quantity + " has nothing to show: " + why});
}

void check_heave(const Scene& scene, const HeaveWatch& watch, Faults& faults) {
  const auto body = find_named(scene.bodies, watch.body);
  if (body == scene.bodies.end())
    faults.push_back({"/output/heave/body", there_is_no("body", watch.body, scene.bodies)});
  else if (body->kind == BodyKind::water || body->fixed)
    faults.push_back(
        {"/output/heave/body", "\"" + watch.body + "\" cannot heave: name a body of soil that is not fixed"});
  else if (!scene.stages.empty() && !present(scene, 0, watch.body))
    faults.push_back({"/output/heave/body", "\"" + watch.body + "\" is removed by the first stage"});
  const auto& probes = scene.output.probes;
  std::vector<std::string> of_head;
  for (const Probe& probe : probes)
    if (probe.quantity == "head") of_head.push_back(probe.name);
  const auto head_probe = [&](const std::string& name, const char* pointer) {
    const auto probe = find_named(probes, name);
    if (probe != probes.end() && probe->quantity == "head") return probe;
    faults.push_back({pointer, there_is_no("probe of quantity head", name, of_head)});
    return probes.end();
  };
  const auto below = head_probe(watch.below, "/output/heave/below");
  const auto above = head_probe(watch.above, "/output/heave/above");
  if (below == probes.end() || above == probes.end()) return;
  double drop = 0;  // how far one falls from `above` to `below`, times gravity
  for (std::size_t axis = 0; axis < 3; ++axis)
    drop += scene.gravity[axis] * (below->at[axis] - above->at[axis]);
  if (!(drop > 0))
    faults.push_back({"/output/heave/below",
                      "the probe \"" + watch.below + "\" at " + text(scene, below->at) + " is not below \"" +
                          watch.above + "\" at " + text(scene, above->at) + ": no gradient between them"});
}

}  // namespace

void check_stages(const Scene& scene, Faults& faults) {
  if (scene.stages.empty()) faults.push_back({"/stages", "there is no stage: give at least one"});
  for (std::size_t k = 0; k < scene.stages.size(); ++k) check_stage(scene, k, faults);
  check_gate_uses(scene, faults);
  check_loads(scene, faults);
}

void check_output(const Scene& scene, Faults& faults) {
  const Output& output = scene.output;
  double total = 0;
  for (const Stage& stage : scene.stages) total += std::max(stage.duration, 0.0);
  const auto check_interval = [&](double interval, double most, const char* pointer, const char* what) {
    if (!(interval * most >= total))
      faults.push_back({pointer, text(interval) + " s over " + text(total) + " s gives more than " +
                                     text(most) + " " + what + ": give at least " + text(total / most) +
                                     " s"});
  };
  check_interval(output.frame_interval, max_frames, "/output/frame_interval", "frames");
  check_interval(output.series_interval, max_samples, "/output/series_interval", "samples");
  std::set<std::string> seen;
  for (std::size_t k = 0; k < output.fields.size(); ++k) {
    const std::string place = at_index("output/fields", k);
    if (!seen.insert(output.fields[k]).second)
      faults.push_back({place, "\"" + output.fields[k] + "\" is listed twice"});
    if (const std::string why = missing_for(scene, output.fields[k]); !why.empty())
      faults.push_back({place, output.fields[k] + " has nothing to show: " + why});
  }
  check_quantities(scene, output.probes, "output/probes", faults);
  check_quantities(scene, output.sections, "output/sections", faults);
  if (output.heave) check_heave(scene, *output.heave, faults);
}

}  // namespace quicksand
