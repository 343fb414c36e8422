#pragma once
// One soil as the step uses it, and its stress update.

#include "engine/materials/drag.hpp"
#include "engine/materials/mohr_coulomb.hpp"
#include "engine/points/points.hpp"

namespace quicksand {

struct SoilMaterial {
  SoilLaw law = SoilLaw::linear_elastic;
  Elastic elastic;
  MohrCoulomb mohr_coulomb;
  Drag drag;
  double grain_density = 2650;  ///< kg/m³
  double porosity = 0.4;        ///< –, initial
  double max_porosity = 1;      ///< –, grains do not touch above it

  static SoilMaterial from(const Soil& soil, const Water& water);
};

/// Velocity gradient, ∂v_i/∂x_j in 1/s.
template <int D>
using Gradient = std::array<Vec<D>, D>;

/// Effective stress after a step of dt seconds with velocity gradient L (Jaumann rate), and the increment
/// of equivalent plastic shear strain √(2/3 e:e). In the plane the out-of-plane strain is zero; about an
/// axis it grows at the rate `hoop` = v_r/r, 1/s.
template <int D>
struct StressUpdate {
  Stress<D> stress;
  double plastic_strain;
};
template <int D>
StressUpdate<D> update_stress(const SoilMaterial& soil, const Stress<D>& stress, const Gradient<D>& l,
                              double dt, double hoop = 0);

extern template StressUpdate<2> update_stress<2>(const SoilMaterial&, const Stress<2>&, const Gradient<2>&,
                                                 double, double);
extern template StressUpdate<3> update_stress<3>(const SoilMaterial&, const Stress<3>&, const Gradient<3>&,
                                                 double, double);

}  // namespace quicksand
