#pragma once
#include "engine/materials/tensor.hpp"

namespace quicksand {

/// Isotropic linear elasticity.
struct Elastic {
  double shear = 0;  ///< Pa, G
  double bulk = 0;   ///< Pa, K
  static Elastic from_young(double young, double poisson) {
    return {young / (2 * (1 + poisson)), young / (3 * (1 - 2 * poisson))};
  }
  double lame() const { return bulk - 2 * shear / 3; }         ///< Pa, λ
  double constrained() const { return bulk + 4 * shear / 3; }  ///< Pa, Ec
  double poisson() const { return (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)); }

  /// Adds what a strain increment makes of stress, without yielding.
  template <class T, std::size_t N>
  QUICKSAND_INLINE void stretch(std::array<T, N>& stress, const std::array<T, N>& strain) const {
    const T volume = lame() * trace(strain);
    for (std::size_t i = 0; i < 3; ++i) stress[i] += 2 * shear * strain[i] + volume;
    for (std::size_t i = 3; i < N; ++i) stress[i] += 2 * shear * strain[i];
  }
  /// J/m³ stored by a stress.
  template <std::size_t N>
  double energy(const std::array<double, N>& stress) const {
    const double t = trace(stress);
    return 0.25 * contracted(deviator(stress)) / shear + t * t / (18 * bulk);
  }
};

}  // namespace quicksand
