#pragma once
#include "engine/materials/soil_material.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// Constrained modulus (Pa) at the body's foot, where soil whose stiffness follows the stress is stiffest:
/// from the weight of grains up to the highest body, or the given stress.
double initial_modulus(const Scene& scene, const Body& body, const SoilMaterial& material);

/// Pa. The stress at which a soil stands in the scene, roughly: what is given at the start, or its weight
/// over the height of all bodies.
double usual_stress(const Scene& scene, const Soil& soil);

}  // namespace quicksand
