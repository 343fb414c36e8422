#pragma once
// What a constitutive law is. A law is one file with one struct, listed in SoilMaterial::Law:
//
//   static L from(const SoilModel&);                      parameters in the law's own terms
//   static void check(const SoilModel&, ModelFaults&);    values that contradict each other
//   static constexpr bool kKeepsPreconsolidation;         which history its points carry
//   static constexpr bool kVariesStiffness;               false: constrained_modulus is the same everywhere
//   static constexpr bool kNeedsStress;                   true: it has no stiffness without initial stress
//   double constrained_modulus(const SoilState<D>&, double porosity) const;   Pa, elastic, for the step's
//   bound double natural_k0() const;                            –, where the scene gives none int
//   begin(SoilState<D>&) const;                       history that belongs to the initial stress int
//   update(SoilState<D>&, const Strain<D>&, double porosity) const; double energy(const SoilState<D>&, double
//   porosity) const;                J/m³, elastic
//
// `update` gets the stress already turned with the material, and the porosity at the start of the step.
// A law may have `update_batch(SoilState<D, BatchLanes>&, const Strain<D, BatchLanes>&, const BatchLanes&
// porosity, int count)` besides, which does the same for the first `count` lanes; the others may become
// anything. `begin` and `update` return how many values it held at a bound other than by its equations (the
// ledger's clamped_values).

#include <string>
#include <vector>

#include "engine/materials/tensor.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// What one soil point carries between steps, or several in lanes.
template <int D, class T = double>
struct SoilState {
  Stress<D, T> stress{};  ///< Pa, effective, tension positive
  T plastic_strain{};     ///< –, accumulated plastic shear strain, Σ √(2/3 e:e) of the deviator e
  T preconsolidation{};   ///< Pa, isotropic
};

/// One of several.
template <int D>
SoilState<D> lane_of(const SoilState<D, BatchLanes>& states, int k) {
  SoilState<D> one{{}, states.plastic_strain[k], states.preconsolidation[k]};
  for (std::size_t i = 0; i < one.stress.size(); ++i) one.stress[i] = states.stress[i][k];
  return one;
}
template <int D>
void set_lane(SoilState<D, BatchLanes>& states, int k, const SoilState<D>& one) {
  for (std::size_t i = 0; i < one.stress.size(); ++i) set_lane(states.stress[i], k, one.stress[i]);
  set_lane(states.plastic_strain, k, one.plastic_strain);
  set_lane(states.preconsolidation, k, one.preconsolidation);
}

template <int D>
SoilState<D> soil_state(const SoilPoints<D>& soil, std::size_t p) {
  return {soil.stress[p], soil.plastic_strain[p],
          soil.preconsolidation.empty() ? 0 : soil.preconsolidation[p]};
}
template <int D>
void set_soil_state(SoilPoints<D>& soil, std::size_t p, const SoilState<D>& state) {
  soil.stress[p] = state.stress;
  soil.plastic_strain[p] = state.plastic_strain;
  if (!soil.preconsolidation.empty()) soil.preconsolidation[p] = state.preconsolidation;
}

/// A fault of a model's parameters; `key` is the name in SoilModel.
struct ModelFault {
  std::string key, detail;
};
using ModelFaults = std::vector<ModelFault>;

}  // namespace quicksand
