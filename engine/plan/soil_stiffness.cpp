#include "engine/plan/soil_stiffness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/scene/region.hpp"

namespace quicksand {

double initial_modulus(const Scene& scene, const Body& body, const SoilMaterial& material) {
  SoilState<3> state;
  double pressure = 0;
  const std::array<double, 6>& given = scene.initial.uniform_stress;
  if (scene.initial.stress == InitialStress::uniform) {
    pressure = -(given[0] + given[1] + given[2]) / 3;
  } else {
    double top = bounding_box(body.region).min[1];
    for (const Body& other : scene.bodies) top = std::max(top, bounding_box(other.region).max[1]);
    const double submerged = body.kind == BodyKind::saturated_soil ? scene.water.density : 0;
    pressure = (1 - material.porosity) * (material.grain_density - submerged) * std::abs(scene.gravity[1]) *
               (top - bounding_box(body.region).min[1]);
  }
  for (int i = 0; i < 3; ++i) state.stress[i] = -pressure;
  return material.constrained_modulus<3>(state, material.porosity);
}

double usual_stress(const Scene& scene, const Soil& soil) {
  const std::array<double, 6>& given = scene.initial.uniform_stress;
  double stress = 0, drop = 0;  // Pa; m²/s², of gravity's potential
  if (scene.initial.stress == InitialStress::uniform) stress = std::abs(given[0] + given[1] + given[2]) / 3;
  for (std::size_t d = 0; d < 3; ++d) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Body& body : scene.bodies) {
      const Bounds box = bounding_box(body.region);
      low = std::min(low, box.min[d]), high = std::max(high, box.max[d]);
    }
    drop += std::abs(scene.gravity[d]) * (high - low);
  }
  stress = std::max(stress, (1 - soil.porosity) * soil.grain_density * drop);
  constexpr double kNone = 1e5;  // where nothing presses, nothing depends on it
  return stress > 0 ? stress : kNone;
}

}  // namespace quicksand
