// Names, materials and the initial state: what refers to what, and what nothing uses.

#include <algorithm>
#include <set>

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

void check_soil(const std::string& name, const Soil& soil, Faults& faults) {
  const SoilModel& model = soil.model;
  if (soil.max_porosity && *soil.max_porosity <= soil.porosity)
    faults.push_back(
        {at_soil(name, "/max_porosity"), text(*soil.max_porosity) + " is not above the porosity " +
                                             text(soil.porosity) + ": the grains would never touch"});
  if (model.law != SoilLaw::mohr_coulomb) return;
  if (model.dilation_angle > model.friction_angle)
    faults.push_back({at_soil(name, "/model/dilation_angle"),
                      text(model.dilation_angle) + "° is above the friction angle " +
                          text(model.friction_angle) +
                          "°: the soil would create energy; give at most the friction angle"});
  if (model.friction_angle == 0 && model.cohesion == 0)
    faults.push_back({at_soil(name, "/model/friction_angle"),
                      "no friction and no cohesion: soil without strength; give one of them"});
}

void check_soil_uses(const Scene& scene, Faults& faults) {
  std::set<std::string> used;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const Body& body = scene.bodies[k];
    if (body.kind == BodyKind::water) continue;
    used.insert(body.soil);
    if (!scene.soils.contains(body.soil))
      faults.push_back(
          {at_index("bodies", k, "/soil"), "there is no soil \"" + body.soil + "\" in materials.soils"});
  }
  for (const auto& [name, soil] : scene.soils)
    if (!used.contains(name))
      faults.push_back({at_soil(name), "no body is made of this soil: remove it or give it to a body"});
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
  for (const auto& [name, soil] : scene.soils) check_soil(name, soil, faults);
  check_soil_uses(scene, faults);
  const bool weightless = scene.gravity == Vec3{0, 0, 0};
  if (weightless && scene.initial.water_table)
    faults.push_back({"/initial/water_table", "has no effect without gravity: remove it"});
  if (weightless && scene.initial.k0)
    faults.push_back({"/initial/k0", "has no effect without gravity: remove it"});
  const bool moving_soil = std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) {
    return body.kind != BodyKind::water && !body.fixed;
  });
  if (scene.numerics.pressure == PressureScheme::explicit_scheme && !scene.water.bulk_modulus)
    faults.push_back(
        {"/numerics/pressure",
         "explicit has no stable step in incompressible water: give materials.water.bulk_modulus a "
         "value or use implicit"});
  const bool tilted = scene.gravity[0] != 0 || scene.gravity[2] != 0;
  if (tilted && moving_soil && scene.initial.stress == InitialStress::k0 &&
      scene.domain.dimension != Dimension::space)
    faults.push_back(
        {"/initial/stress", "k0 needs gravity along the vertical axis only: use zero or uniform"});
}

}  // namespace quicksand
