#include "engine/plan/soil_stiffness.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace quicksand
