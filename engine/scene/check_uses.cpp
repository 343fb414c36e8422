// Names, materials and the initial state: what refers to what, and what nothing uses.

#include <algorithm>
#include <set>

#include "engine/materials/soil_material.hpp"
#include "engine/scene/check_parts.hpp"

namespace quicksand {
namespace {

/// Names that occurred before in the same list.
template <typename Items>
void check_unique(const Items& items, const char* list, Faults& faults) {
  std::set<std::string> seen;
  for (std::size_t k = 0; k < items.size(); ++k)
    if (!seen.insert(items[k].name).second)
      faults.push_back(
          {at_index(list, k, "/name"), "the name \"" + items[k].name + "\" is used twice: choose another"});
}

void check_soil(const std::string& name, const Soil& soil, InitialStress stress, Faults& faults) {
  const SoilModel& model = soil.model;
  if (soil.max_porosity && *soil.max_porosity <= soil.porosity && stress != InitialStress::zero)
    faults.push_back({at_soil(name, "/max_porosity"),
                      text(*soil.max_porosity) + " is not above the porosity " + text(soil.porosity) +
                          ": grains that do not touch at the start need initial.stress zero"});
  for (const auto& [key, detail] : check_model(model))
    faults.push_back({at_soil(name, "/model/" + key), detail});
}

void check_soil_uses(const Scene& scene, Faults& faults) {
  std::set<std::string> used;
  std::vector<std::string> names;
  for (const auto& [name, soil] : scene.soils) names.push_back(name);
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const Body& body = scene.bodies[k];
    if (body.kind == BodyKind::water) continue;
    used.insert(body.soil);
    if (!scene.soils.contains(body.soil))
      faults.push_back({at_index("bodies", k, "/soil"), there_is_no("soil", body.soil, names)});
  }
  for (const auto& [name, soil] : scene.soils)
    if (!used.contains(name))
      faults.push_back({at_soil(name), "no body is made of this soil: remove it or give it to a body"});
}

/// K0 acts on soil that moves, under weight; a soil's own wins over the scene's.
void check_k0(const Scene& scene, Faults& faults) {
  const bool weightless = scene.gravity == Vec3{0, 0, 0};
  std::set<std::string> moving;
  for (const Body& body : scene.bodies)
    if (body.kind != BodyKind::water && !body.fixed) moving.insert(body.soil);
  for (const auto& [name, soil] : scene.soils) {
    if (!soil.k0) continue;
    if (weightless) faults.push_back({at_soil(name, "/k0"), "has no effect without gravity: remove it"});
    if (!moving.contains(name))
      faults.push_back({at_soil(name, "/k0"), "has no effect: no body that moves is made of this soil"});
  }
  if (!scene.initial.k0) return;
  if (weightless) faults.push_back({"/initial/k0", "has no effect without gravity: remove it"});
  const auto has_own = [&](const std::string& name) {
    const auto soil = scene.soils.find(name);
    return soil != scene.soils.end() && soil->second.k0;
  };
  if (std::all_of(moving.begin(), moving.end(), has_own))
    faults.push_back({"/initial/k0", moving.empty() ? "has no effect: no soil moves"
                                                    : "has no effect: every soil that moves has its own k0"});
}

/// Soils that have no stiffness without stress.
void check_stress(const Scene& scene, Faults& faults) {
  const bool stress_free = scene.initial.stress == InitialStress::zero ||
                           (scene.initial.stress == InitialStress::k0 && scene.gravity == Vec3{0, 0, 0});
  if (!stress_free) return;
  for (const Body& body : scene.bodies) {
    const auto soil = scene.soils.find(body.soil);
    if (body.kind != BodyKind::water && !body.fixed && soil != scene.soils.end() &&
        needs_initial_stress(soil->second.model))
      faults.push_back({"/initial/stress", "the soil \"" + soil->first + "\" of the body \"" + body.name +
                                               "\" has no stiffness without stress: give k0 with gravity, " +
                                               "or uniform with uniform_stress"});
  }
}

}  // namespace

void check_names(const Scene& scene, Faults& faults) {
  check_unique(scene.bodies, "bodies", faults);
  check_unique(scene.walls, "walls", faults);
  check_unique(scene.gates, "gates", faults);
  check_unique(scene.reservoirs, "reservoirs", faults);
  check_unique(scene.loads, "loads", faults);
  check_unique(scene.stages, "stages", faults);
  check_unique(scene.output.probes, "output/probes", faults);
  check_unique(scene.output.sections, "output/sections", faults);
}

void check_materials(const Scene& scene, Faults& faults) {
  for (const auto& [name, soil] : scene.soils) check_soil(name, soil, scene.initial.stress, faults);
  check_soil_uses(scene, faults);
  if (scene.gravity == Vec3{0, 0, 0} && scene.initial.water_table)
    faults.push_back({"/initial/water_table", "has no effect without gravity: remove it"});
  check_k0(scene, faults);
  const bool moving_soil = std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) {
    return body.kind != BodyKind::water && !body.fixed;
  });
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    if (scene.bodies[k].rotation_rate != 0 && scene.domain.dimension == Dimension::axisymmetric)
      faults.push_back({at_index("bodies", k, "/rotation_rate"),
                        "a body that turns in the plane is not symmetric about the axis: remove it"});
  if (moving_soil && scene.numerics.kernel == Kernel::linear && scene.numerics.points_per_cell == 1)
    faults.push_back(
        {"/numerics/points_per_cell",
         "1 leaves soil with the linear kernel unstable at any step, as one point feels nothing of the "
         "strain between the faces: give at least 2, or the quadratic kernel"});
  if (scene.numerics.pressure == PressureScheme::explicit_scheme && !scene.water.bulk_modulus)
    faults.push_back(
        {"/numerics/pressure",
         "explicit has no stable step in incompressible water: give materials.water.bulk_modulus a "
         "value or use implicit"});
  check_stress(scene, faults);
  const bool tilted = scene.gravity[0] != 0 || scene.gravity[2] != 0;
  if (tilted && moving_soil && scene.initial.stress == InitialStress::k0 &&
      scene.domain.dimension != Dimension::space)
    faults.push_back(
        {"/initial/stress", "k0 needs gravity along the vertical axis only: use zero or uniform"});
}

}  // namespace quicksand
