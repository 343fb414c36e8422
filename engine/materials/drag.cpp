#include "engine/materials/drag.hpp"

namespace quicksand {

namespace {
/// Hydraulic conductivity is defined under standard gravity, m/s², whatever the scene's gravity is:
/// what stays the same on the moon or in a centrifuge is k/(ρw g).
constexpr double kStandardGravity = 9.81;
}  // namespace

Drag Drag::from(const Soil& soil, const Water& water) {
  const double n = soil.porosity;
  if (soil.permeability.value <= 0) return {0, n, false};  // dry soil has none
  return {n * n * water.density * kStandardGravity / soil.permeability.value, n,
          soil.permeability.law == PermeabilityLaw::kozeny_carman};
}

}  // namespace quicksand
