#pragma once
#include "engine/materials/soil_material.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// Constrained modulus (Pa) at the body's foot, where soil whose stiffness follows the stress is stiffest:
/// from the weight of grains up to the highest body, or the given stress.
double initial_modulus(const Scene& scene, const Body& body, const SoilMaterial& material);

}  // namespace quicksand
