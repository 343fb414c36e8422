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
// `begin` and `update` return how many values it held at a bound other than by its equations (the ledger's
// clamped_values).

#include <string>
#include <vector>

#include "engine/materials/tensor.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// What one soil point carries between steps.
template <int D>
struct SoilState {
  Stress<D> stress{};           ///< Pa, effective, tension positive
  double plastic_strain = 0;    ///< –, accumulated plastic shear strain, Σ √(2/3 e:e) of the deviator e
  double preconsolidation = 0;  ///< Pa, isotropic
};

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
