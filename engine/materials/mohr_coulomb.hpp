#pragma once
#include <array>
#include <limits>

#include "engine/materials/elastic.hpp"
#include "engine/materials/law.hpp"

namespace quicksand {

/// Mohr–Coulomb strength with non-associated flow, linear elastic inside.
struct MohrCoulomb {
  double sin_phi = 0, cos_phi = 1;                           ///< friction angle
  double sin_psi = 0;                                        ///< dilation angle
  double cohesion = 0;                                       ///< Pa
  double tension = std::numeric_limits<double>::infinity();  ///< Pa, largest principal stress

  /// Tension at the pyramid's tip, c cot φ; infinite without friction.
  double apex() const {
    return sin_phi > 0 ? cohesion * cos_phi / sin_phi : std::numeric_limits<double>::infinity();
  }
};

enum class YieldRegion { elastic, face, edge_extension, edge_compression, apex, tension };

/// Principal stresses (tension positive, sorted: s[0] ≥ s[1] ≥ s[2]) after the return.
struct MohrCoulombReturn {
  std::array<double, 3> stress;          ///< Pa
  std::array<double, 3> plastic_strain;  ///< –, principal increments
  YieldRegion region;
};
/// √(2/3 e:e) of the plastic strain's deviator e.
inline double plastic_shear(const MohrCoulombReturn& r) {
  return std::sqrt(2.0 / 3.0 * contracted(deviator(r.plastic_strain)));
}

/// Implicit return in principal stress space: onto the face σ1–σ3, else onto the edge where two faces
/// meet, else to the apex c·cot φ. With linear faces each return is exact in one step. Planes of largest
/// tension, with associated flow, cut the pyramid below its apex; see tension_cutoff.cpp.
/// `trial` must be sorted. A stress of exactly zero with c = 0 is admissible and stays.
/// Source: E. A. de Souza Neto, D. Perić, D. R. J. Owen, Computational Methods for Plasticity, ch. 8.
MohrCoulombReturn return_map(const MohrCoulomb& law, const Elastic& elastic,
                             const std::array<double, 3>& trial);
/// The return where the tension cut-off is active.
MohrCoulombReturn return_to_cutoff(const MohrCoulomb& law, const Elastic& elastic,
                                   const std::array<double, 3>& trial);

/// The return onto the edge where the face σ1–σ3 and another one meet: what does not depend on the trial.
struct EdgeReturn {
  std::array<double, 3> drop{};  ///< Pa, of the stress per plastic multiplier of the other face
  double own = 0, other = 0;  ///< 1/Pa, multiplier of a face: own × its excess − other × the other's excess
  double shear = 0;           ///< –, 2/3 e₁:e₂ of both faces, each per plastic multiplier
};

/// The return onto the face σ1–σ3, where it mostly ends, and onto its edges: what does not depend on the
/// trial nor on the cohesion.
struct FaceReturn {
  std::array<double, 3> drop{};       ///< Pa, of the stress per plastic multiplier
  double compliance = 0;              ///< 1/Pa, plastic multiplier per excess over yield
  double shear = 0;                   ///< –, √(2/3 e:e) per plastic multiplier
  EdgeReturn compression, extension;  ///< with σ2–σ3, where σ1 = σ2; with σ1–σ2, where σ2 = σ3

  static FaceReturn of(const MohrCoulomb& law, const Elastic& elastic);
};

/// Linear elastic, perfectly plastic or with cohesion that softens: linearly from `cohesion` to
/// `residual_cohesion` while the accumulated plastic shear strain Σ √(2/3 e:e) grows to `softening_strain`.
/// A step takes the cohesion at its start. Softening concentrates strain in bands one cell wide, so that what
/// a scene does after its peak depends on the cell size.
struct MohrCoulombLaw {
  static constexpr bool kKeepsPreconsolidation = false, kVariesStiffness = false, kNeedsStress = false;
  Elastic elastic;
  MohrCoulomb peak;
  double residual_cohesion = 0;  ///< Pa
  double softening_strain = 0;   ///< –; 0: cohesion stays
  FaceReturn face;               ///< the same for every cohesion

  static MohrCoulombLaw from(const SoilModel& model);
  static void check(const SoilModel& model, ModelFaults& faults);

  /// Pa, after so much plastic shear strain.
  template <class T>
  QUICKSAND_INLINE T cohesion(const T& plastic_strain) const {
    if (softening_strain <= 0) return all_lanes<T>(peak.cohesion);
    const T part = clamped<T>(plastic_strain / softening_strain, T{}, all_lanes<T>(1));
    return peak.cohesion + (residual_cohesion - peak.cohesion) * part;
  }

  template <int D>
  double constrained_modulus(const SoilState<D>&, double /*porosity*/) const {
    return elastic.constrained();
  }
  /// J. Jáky, 1 − sin φ.
  double natural_k0() const { return 1 - peak.sin_phi; }
  template <int D>
  int begin(SoilState<D>&) const {
    return 0;
  }
  template <int D>
  int update(SoilState<D>& state, const Strain<D>& strain, double /*porosity*/) const {
    elastic.stretch(state.stress, strain);
    const double c = cohesion(state.plastic_strain);
    if (may_yield<D>(c, state)) yield(c, state);
    return 0;
  }
  template <int D>
  int update_batch(SoilState<D, BatchLanes>& state, const Strain<D, BatchLanes>& strain,
                   const BatchLanes& porosity, int count) const;
  template <int D>
  double energy(const SoilState<D>& state, double /*porosity*/) const {
    return elastic.energy(state.stress);
  }

 private:
  /// False where the bounds of the principal stresses say that none yields.
  template <int D, class T>
  QUICKSAND_INLINE auto may_yield(const T& c, const SoilState<D, T>& state) const {
    const PrincipalBounds<T> s = principal_bounds<D>(state.stress);
    return (s.largest * (1 + peak.sin_phi) - s.smallest * (1 - peak.sin_phi) > 2 * peak.cos_phi * c) |
           (s.largest > peak.tension);
  }
  /// Brings a trial stress back, if it yields.
  template <int D>
  void yield(double cohesion, SoilState<D>& state) const;
};

}  // namespace quicksand
