#pragma once
#include <algorithm>
#include <cmath>

#include "engine/materials/law.hpp"

namespace quicksand {

/// Modified Cam-Clay: yield f = q²/M² + p (p − pc) ≤ 0 with associated flow, hardening with the plastic
/// void ratio, dpc = −pc de^p/(λ−κ), and elasticity whose stiffness follows the pressure, K = (1+e) p/κ, with
/// constant Poisson's ratio. p is compression positive here, e the void ratio.
/// The elasticity is hypoelastic: with G ∝ p a closed loop of stress may gain or lose a little energy, and
/// the stored energy p κ/(1+e) + q²/(6G) is exact for changes of p alone. Sources: K. H. Roscoe, J. B.
/// Burland 1968; R. I. Borja, Cam-Clay plasticity, part II, CMAME 88 (1991), for the implicit return with
/// exponential elasticity.
struct CamClayLaw {
  static constexpr bool kKeepsPreconsolidation = true, kVariesStiffness = true, kNeedsStress = true;

  /// Least mean pressure as a part of the scene's usual stress: the weight of a millimetre of water where
  /// that is 100 kPa. Below it a clay without cohesion would have no stiffness and no way back; p and pc are
  /// held there and the ledger counts it. Larger: longer steps for clay that barely touches, which is then
  /// stiffer.
  static constexpr double kLeastPart = 1e-4;

  double least_pressure = 10;     ///< Pa
  double compression = 0;         ///< –, λ
  double swelling = 0;            ///< –, κ
  double slope = 0;               ///< –, M
  double shear_ratio = 0;         ///< –, G/K
  double over_consolidation = 1;  ///< –, pc over the yield pressure of the initial stress

  static CamClayLaw from(const SoilModel& model);
  static void check(const SoilModel& model, ModelFaults& faults);

  /// Tangent of the elastic law, Pa.
  double bulk(double pressure, double porosity) const {
    return std::max(pressure, least_pressure) / ((1 - porosity) * swelling);
  }
  template <int D>
  double constrained_modulus(const SoilState<D>& state, double porosity) const {
    return bulk(-trace(state.stress) / 3, porosity) * (1 + 4 * shear_ratio / 3);
  }
  /// 1 − sin φ with the friction angle of triaxial compression, sin φ = 3M/(6+M).
  double natural_k0() const { return 1 - 3 * slope / (6 + slope); }
  template <int D>
  int begin(SoilState<D>& state) const;
  template <int D>
  int update(SoilState<D>& state, const Strain<D>& strain, double porosity) const;
  template <int D>
  double energy(const SoilState<D>& state, double porosity) const {
    const double p = std::max(-trace(state.stress) / 3, 0.0), shear = shear_ratio * bulk(p, porosity);
    return p * swelling * (1 - porosity) + contracted(deviator(state.stress)) / (4 * shear);
  }
};

}  // namespace quicksand
