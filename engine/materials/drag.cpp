#include "engine/materials/drag.hpp"

namespace quicksand {

namespace {
/// Hydraulic conductivity is defined under standard gravity, m/s², whatever the scene's gravity is:
/// what stays the same on the moon or in a centrifuge is k/(ρw g).
constexpr double kStandardGravity = 9.81;
/// Ergun's constants for packed grains.
constexpr double kErgunViscous = 150, kErgunInertial = 1.75;
}  // namespace

Drag Drag::from(const Soil& soil, const Water& water) {
  Drag drag;
  drag.law = soil.permeability.law;
  drag.porosity = soil.porosity;
  drag.exponent = soil.permeability.exponent;
  if (drag.law == PermeabilityLaw::ergun) {
    const double d = soil.permeability.grain_size;
    drag.viscous = kErgunViscous * water.viscosity / (d * d);
    drag.inertial = kErgunInertial * water.density / d;
  } else if (soil.permeability.value > 0) {  // dry soil has none
    drag.reference = water.density * kStandardGravity / soil.permeability.value;
  }
  return drag;
}

}  // namespace quicksand
