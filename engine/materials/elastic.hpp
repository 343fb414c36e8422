#pragma once
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
};

}  // namespace quicksand
