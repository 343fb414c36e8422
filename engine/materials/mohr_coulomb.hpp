#pragma once
#include <array>

#include "engine/materials/elastic.hpp"

namespace quicksand {

/// Mohr–Coulomb strength with non-associated flow, linear elastic inside.
struct MohrCoulomb {
  double sin_phi = 0, cos_phi = 1;  ///< friction angle
  double sin_psi = 0;               ///< dilation angle
  double cohesion = 0;              ///< Pa
};

enum class YieldRegion { elastic, face, edge_extension, edge_compression, apex };

/// Principal stresses (tension positive, sorted: s[0] ≥ s[1] ≥ s[2]) after the return.
struct MohrCoulombReturn {
  std::array<double, 3> stress;          ///< Pa
  std::array<double, 3> plastic_strain;  ///< –, principal increments
  YieldRegion region;
};

/// Implicit return in principal stress space: onto the face σ1–σ3, else onto the edge where two faces
/// meet, else to the apex c·cot φ. With linear faces each return is exact in one step.
/// `trial` must be sorted. A stress of exactly zero with c = 0 is admissible and stays.
/// Source: E. A. de Souza Neto, D. Perić, D. R. J. Owen, Computational Methods for Plasticity, ch. 8.
MohrCoulombReturn return_map(const MohrCoulomb& law, const Elastic& elastic,
                             const std::array<double, 3>& trial);

}  // namespace quicksand
