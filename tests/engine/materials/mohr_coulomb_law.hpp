#pragma once
// The stiffness and the law that tests of Mohr–Coulomb share.

#include <array>
#include <cmath>
#include <numbers>

#include "engine/materials/mohr_coulomb.hpp"

namespace quicksand::test {

inline const Elastic kElastic = Elastic::from_young(1e7, 0.3);

/// Angles in degrees, cohesion and largest tension in Pa.
inline MohrCoulomb law(double phi, double psi, double cohesion, double tension = MohrCoulomb{}.tension) {
  constexpr double kRadians = std::numbers::pi / 180;
  return {std::sin(phi * kRadians), std::cos(phi * kRadians), std::sin(psi * kRadians), cohesion, tension};
}

/// Pa, above zero beyond the face σ1–σ3.
inline double yield(const MohrCoulomb& m, const std::array<double, 3>& s) {
  return s[0] - s[2] + (s[0] + s[2]) * m.sin_phi - 2 * m.cohesion * m.cos_phi;
}

}  // namespace quicksand::test
