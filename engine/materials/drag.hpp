#pragma once
#include "engine/grid/lanes.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// Resistance of the grains to the water that passes them, per bulk volume and relative velocity.
struct Drag {
  PermeabilityLaw law = PermeabilityLaw::kozeny_carman;
  double reference = 0;              ///< N·s/m⁴, ρw g/k at the initial porosity
  double porosity = 0.4;             ///< –, n0
  double exponent = 0;               ///< –, power
  double viscous = 0, inertial = 0;  ///< Pa·s/m² and kg/m⁴, 150 μ/d² and 1.75 ρw/d of Ergun

  /// Conductivity is meant under standard gravity, 9.81 m/s²; without permeability (dry soil) R = 0.
  static Drag from(const Soil& soil, const Water& water);

  /// Pressure gradient per discharge, R/n² = ρw g/k (N·s/m⁴). This is what adds up along a flow path, so
  /// faces average it and multiply by their own n²: a layer's edges, half soil and half water, then resist as
  /// half. `discharge` is n |vw − vs| in m/s; only Ergun's law asks for it.
  /// T is double, or lanes of several points.
  template <class T>
  QUICKSAND_INLINE T resistivity(const T& n, const std::type_identity_t<T>& discharge = T{}) const {
    switch (law) {
      case PermeabilityLaw::constant:
        return all_lanes<T>(reference);
      case PermeabilityLaw::kozeny_carman: {  // k = k0 [n³/(1−n)²]/[n0³/(1−n0)²]
        const T grains = (1 - n) * (1 / (1 - porosity)), pores = porosity / n;
        return reference * grains * grains * pores * pores * pores;
      }
      case PermeabilityLaw::power:  // k = k0 [(1+e)/(1+e0)]^exponent with 1+e = 1/(1−n)
        return reference * power<T>((1 - n) * (1 / (1 - porosity)), exponent);
      case PermeabilityLaw::ergun:  // S. Ergun 1952: ∇p = 150 μ(1−n)²/(n³d²) U + 1.75 ρw(1−n)/(n³d) U²
        return (viscous * (1 - n) + inertial * discharge) * (1 - n) / (n * n * n);
    }
    return T{};
  }

  /// R(n) of [FMS19], N·s/m⁴: the force on the grains per bulk volume and relative velocity.
  double resistance(double n, double discharge = 0) const { return n * n * resistivity(n, discharge); }

  bool follows_speed() const { return inertial > 0; }
};

}  // namespace quicksand
