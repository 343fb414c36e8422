#include "engine/plan/quasi_static.hpp"

#include <algorithm>
#include <cmath>

#include "engine/plan/soil_stiffness.hpp"
#include "engine/scene/region.hpp"
#include "engine/scene/stages.hpp"
#include "engine/scene/text.hpp"

namespace quicksand {
namespace {

struct Extents {
  Vec3 min{}, max{};
  bool empty = true;
  void include(const Bounds& b) {
    for (std::size_t d = 0; d < 3; ++d) {
      min[d] = empty ? b.min[d] : std::min(min[d], b.min[d]);
      max[d] = empty ? b.max[d] : std::max(max[d], b.max[d]);
    }
    empty = false;
  }
};

bool counts(const Scene& scene, std::size_t stage, const Body& body) {
  return body.kind != BodyKind::water && !body.fixed && present(scene, stage, body.name);
}

/// Size of a body, m² in the plane, m³ in space (bodies that are extruded: m² of their section).
double size_of(const Scene& scene, const Body& body) {
  if (axes(scene) == 2) return area(body.region, scene.cell_size());
  const Bounds box = bounding_box(body.region);
  const double depth = box.max[2] > box.min[2] ? box.max[2] - box.min[2] : 1;
  return depth * area(at_depth(body.region, 0.5 * (box.min[2] + box.max[2])), scene.cell_size());
}

}  // namespace

SlowProcess slow_process(const Scene& scene, std::size_t stage) {
  SlowProcess slow;
  slow.process_time = scene.stages[stage].duration;
  Extents all;
  double size = 0;
  for (const Body& body : scene.bodies)
    if (counts(scene, stage, body)) all.include(bounding_box(body.region)), size += size_of(scene, body);
  if (all.empty || !(size > 0)) return slow;

  const double height = all.max[1] - all.min[1];
  double largest = height, resistance = 0, compliance = 0;
  for (std::size_t d = 0; d < axes(scene); ++d) largest = std::max(largest, all.max[d] - all.min[d]);
  for (const Body& body : scene.bodies) {
    if (!counts(scene, stage, body)) continue;
    const Soil& soil = scene.soils.at(body.soil);
    const SoilMaterial material = SoilMaterial::from(soil, scene.water, usual_stress(scene, soil));
    const double thickness = height * size_of(scene, body) / size,
                 modulus = initial_modulus(scene, body, material);
    double slowness = std::sqrt((1 - soil.porosity) * soil.grain_density / modulus);  // s/m
    if (body.kind == BodyKind::saturated_soil && scene.water.bulk_modulus)
      slowness =
          std::max(slowness, kWaterTransits * std::sqrt(scene.water.density / *scene.water.bulk_modulus));
    slow.transit_time += largest / height * thickness * slowness;
    if (body.kind != BodyKind::saturated_soil) continue;
    resistance += thickness * material.drag.resistivity(soil.porosity);
    // Pore water stores too: soft water beside stiff grains sets the pace. The larger of the two, which is
    // within a factor of two of their sum, so that stiff water changes nothing.
    const double stored = scene.water.bulk_modulus ? soil.porosity / *scene.water.bulk_modulus : 0;
    compliance += thickness * std::max(1 / modulus, stored);
  }
  if (resistance > 0) slow.process_time = std::min(slow.process_time, resistance * compliance);
  if (!scene.stages[stage].quasi_static) return slow;
  const double transits = slow.process_time / slow.transit_time;  // with true inertia
  slow.inertia = std::max(1.0, std::pow(transits / scene.numerics.quasi_static_transits, 2));
  return slow;
}

}  // namespace quicksand
