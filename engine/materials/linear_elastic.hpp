#pragma once
#include "engine/materials/elastic.hpp"
#include "engine/materials/law.hpp"

namespace quicksand {

/// Isotropic linear elasticity in rate form: the Jaumann rate of stress is C : strain rate. A constant
/// modulus over the rate of strain, so that compression by the factor J gives Ec ln J.
struct LinearElasticLaw {
  static constexpr bool kKeepsPreconsolidation = false, kVariesStiffness = false, kNeedsStress = false;
  Elastic elastic;

  static LinearElasticLaw from(const SoilModel& m) {
    return {Elastic::from_young(m.young_modulus, m.poisson_ratio)};
  }
  static void check(const SoilModel&, ModelFaults&) {}

  template <int D>
  double constrained_modulus(const SoilState<D>&, double /*porosity*/) const {
    return elastic.constrained();
  }
  /// Grains that cannot move sideways.
  double natural_k0() const { return elastic.poisson() / (1 - elastic.poisson()); }
  template <int D>
  int begin(SoilState<D>&) const {
    return 0;
  }
  template <int D>
  int update(SoilState<D>& state, const Strain<D>& strain, double /*porosity*/) const {
    elastic.stretch(state.stress, strain);
    return 0;
  }
  template <int D>
  QUICKSAND_INLINE int update_batch(SoilState<D, BatchLanes>& state, const Strain<D, BatchLanes>& strain,
                                    const BatchLanes& /*porosity*/, int /*count*/) const {
    elastic.stretch(state.stress, strain);
    return 0;
  }
  template <int D>
  double energy(const SoilState<D>& state, double /*porosity*/) const {
    return elastic.energy(state.stress);
  }
};

}  // namespace quicksand
