#pragma once
#include "engine/scene/scene.hpp"

namespace quicksand {

/// Resistance of the grains to the water that passes them, per bulk volume and relative velocity.
struct Drag {
  double at_reference = 0;  ///< N·s/m⁴, n0² ρw g / k
  double porosity = 0.4;    ///< –, n0
  bool follows_porosity = true;

  /// Conductivity is meant under standard gravity, 9.81 m/s²; without permeability (dry soil) R = 0.
  static Drag from(const Soil& soil, const Water& water);

  /// R(n). Darcy: n² ρw g / k [FMS19]. Kozeny–Carman: k = k0 [n³/(1−n)²]/[n0³/(1−n0)²].
  double resistance(double n) const {
    if (!follows_porosity) return at_reference * n * n / (porosity * porosity);
    const double grains = (1 - n) / (1 - porosity);
    return at_reference * grains * grains * porosity / n;
  }

  /// Pressure gradient per discharge, R/n² = ρw g/k (N·s/m⁴). This is what adds up along a flow path, so
  /// faces average it and multiply by their own n²: a layer's edges, half soil and half water, then resist as
  /// half.
  double resistivity(double n) const { return resistance(n) / (n * n); }
};

}  // namespace quicksand
