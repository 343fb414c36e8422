// Moduli against the weight that they bear. Soil and water are linear in the logarithm of their volume; where
// the weight of a body alone exceeds its modulus, it would shrink to less than 1/e of its height, which no
// soil or water does: steps would be stable and the picture wrong.

#include <algorithm>
#include <cmath>

#include "engine/scene/check_parts.hpp"
#include "engine/scene/region.hpp"

namespace quicksand {
namespace {

/// m²/s², difference of the potential of gravity across a box.
double drop(const Vec3& gravity, const Bounds& box) {
  double sum = 0;
  for (std::size_t d = 0; d < 3; ++d) sum += std::abs(gravity[d]) * (box.max[d] - box.min[d]);
  return sum;
}

std::string too_soft(double modulus, const std::string& what, double weight) {
  return text(modulus) + " Pa is below " + what + ", " + text(weight) +
         " Pa, which would press it to a fraction of its volume: give a stiffness well above it, 10 times "
         "for strains of a tenth";
}

void check_soils(const Scene& scene, Faults& faults) {
  for (const auto& [name, soil] : scene.soils) {
    if (soil.model.law == SoilLaw::modified_cam_clay) continue;  // its stiffness follows the stress
    double weight = 0;
    for (const Body& body : scene.bodies) {
      if (body.kind == BodyKind::water || body.fixed || body.soil != name) continue;
      const double around = body.kind == BodyKind::saturated_soil ? scene.water.density : 0;
      const double density = (1 - soil.porosity) * std::abs(soil.grain_density - around);
      weight = std::max(weight, density * drop(scene.gravity, bounding_box(body.region)));
    }
    if (weight > soil.model.young_modulus)
      faults.push_back(
          {at_soil(name, "/model/young_modulus"),
           too_soft(soil.model.young_modulus, "the weight of the soil in its own body", weight)});
  }
}

void check_water(const Scene& scene, Faults& faults) {
  if (!scene.water.bulk_modulus) return;
  Bounds wet;
  for (const Body& body : scene.bodies) {
    if (body.kind == BodyKind::soil) continue;
    const Bounds box = bounding_box(body.region);
    if (wet.empty) wet = box;
    for (std::size_t d = 0; d < 3; ++d) {
      wet.min[d] = std::min(wet.min[d], box.min[d]);
      wet.max[d] = std::max(wet.max[d], box.max[d]);
    }
  }
  double highest = wet.empty ? 0 : drop(scene.gravity, wet);
  const double g = std::hypot(scene.gravity[0], scene.gravity[1], scene.gravity[2]);
  const auto consider = [&](double head) { highest = std::max(highest, g * (head - scene.domain.min[1])); };
  for (const Reservoir& reservoir : scene.reservoirs) consider(reservoir.head);
  for (const Stage& stage : scene.stages)
    for (const auto& [name, head] : stage.heads) consider(head);
  double pressure = scene.water.density * highest;
  if (scene.initial.pressure == InitialPressure::uniform)
    pressure = std::max(pressure, std::abs(scene.initial.uniform_pressure));
  if (pressure > *scene.water.bulk_modulus)
    faults.push_back({"/materials/water/bulk_modulus",
                      too_soft(*scene.water.bulk_modulus, "the pressure of the water at rest", pressure) +
                          ", or \"incompressible\""});
}

}  // namespace

void check_softness(const Scene& scene, Faults& faults) {
  check_soils(scene, faults);
  check_water(scene, faults);
}

}  // namespace quicksand
