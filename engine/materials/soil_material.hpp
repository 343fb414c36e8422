#pragma once
// One soil as the step uses it, and its stress update.

#include <optional>
#include <variant>

#include "engine/materials/cam_clay.hpp"
#include "engine/materials/drag.hpp"
#include "engine/materials/linear_elastic.hpp"
#include "engine/materials/mohr_coulomb.hpp"

namespace quicksand {

/// The laws, in the order of the choices of SoilLaw.
using Law = std::variant<LinearElasticLaw, MohrCoulombLaw, CamClayLaw>;

/// f(law), as std::visit, but by branches that a processor foresees and a compiler looks through.
template <class F>
inline decltype(auto) with_law(const Law& law, F&& f) {
  if (const auto* mohr_coulomb = std::get_if<MohrCoulombLaw>(&law)) return f(*mohr_coulomb);
  if (const auto* cam_clay = std::get_if<CamClayLaw>(&law)) return f(*cam_clay);
  return f(*std::get_if<LinearElasticLaw>(&law));
}

struct SoilMaterial {
  Law law;
  Drag drag;
  double grain_density = 2650;  ///< kg/m³
  double porosity = 0.4;        ///< –, initial
  double max_porosity = 1;      ///< –, grains do not touch above it
  double shear_share = 0;       ///< –, elastic shear over constrained modulus, (1−2ν)/(2(1−ν))
  std::optional<double> k0{};   ///< –, horizontal over vertical effective stress at the start, if given

  /// `usual_stress`, Pa: of the scene, from which laws take what is small.
  static SoilMaterial from(const Soil& soil, const Water& water, double usual_stress = 1e5);

  /// Elastic constrained modulus of a point, Pa: what its waves travel with.
  template <int D>
  double constrained_modulus(const SoilState<D>& state, double n) const {
    return with_law(law, [&](const auto& l) { return l.template constrained_modulus<D>(state, n); });
  }
  /// Horizontal over vertical effective stress where the scene gives none.
  double natural_k0() const {
    return with_law(law, [](const auto& l) { return l.natural_k0(); });
  }
  bool varies_stiffness() const {
    return with_law(law, [](const auto& l) { return l.kVariesStiffness; });
  }
  bool keeps_preconsolidation() const {
    return with_law(law, [](const auto& l) { return l.kKeepsPreconsolidation; });
  }
  /// Elastic energy per bulk volume, J/m³.
  template <int D>
  double energy(const SoilState<D>& state, double n) const {
    return with_law(law, [&](const auto& l) { return l.template energy<D>(state, n); });
  }
  /// Makes the history that belongs to an initial stress; returns how many values it held at a bound.
  template <int D>
  int begin(SoilState<D>& state) const {
    return with_law(law, [&](const auto& l) { return l.template begin<D>(state); });
  }
};

/// Parameters of a model that contradict each other, as its law says, and whether the law has no stiffness
/// without initial stress.
ModelFaults check_model(const SoilModel& model);
bool needs_initial_stress(const SoilModel& model);

namespace soil_update {

template <int D, class Law>
int one_lane(const Law& law, int k, SoilState<D, BatchLanes>& states, const Strain<D, BatchLanes>& strains,
             const BatchLanes& n) {
  SoilState<D> state = lane_of(states, k);
  Strain<D> strain;
  for (std::size_t i = 0; i < strain.size(); ++i) strain[i] = strains[i][k];
  const int held = law.template update<D>(state, strain, n[k]);
  set_lane(states, k, state);
  return held;
}

template <int D, class Law>
QUICKSAND_INLINE int all_lanes_of(const Law& law, int count, SoilState<D, BatchLanes>& states,
                                  const Strain<D, BatchLanes>& strains, const BatchLanes& n) {
  if constexpr (requires { law.template update_batch<D>(states, strains, n, count); }) {
    return law.template update_batch<D>(states, strains, n, count);
  } else {
    int held = 0;
    for (int k = 0; k < count; ++k) held += one_lane<D>(law, k, states, strains, n);
    return held;
  }
}

/// Turns the stress and returns the strain, both with the middle of the motion.
template <int D, class T>
QUICKSAND_INLINE Strain<D, T> turn(SoilState<D, T>& state, const Gradient<D, T>& l, double dt,
                                   const T& hoop) {
  const Gradient<D, T> middle = midpoint_gradient<D, T>(l, dt);
  state.stress = rotated<D, T>(state.stress, middle, dt);
  return strain_increment<D, T>(middle, dt, hoop);
}

}  // namespace soil_update

/// State after a step of dt seconds with velocity gradient L (Jaumann rate), from porosity `n` at its start.
/// In the plane the out-of-plane strain is zero; about an axis it grows at the rate `hoop` = v_r/r, 1/s.
/// Returns how many values were held at a bound other than by the law's equations.
template <int D>
int update_state(const SoilMaterial& soil, SoilState<D>& state, double n, const Gradient<D>& l, double dt,
                 double hoop = 0) {
  const Strain<D> strain = soil_update::turn<D, double>(state, l, dt, hoop);
  return with_law(soil.law, [&](const auto& law) { return law.template update<D>(state, strain, n); });
}

/// The same for the first `count` of several points, each of its own soil; the others may become anything.
template <int D>
QUICKSAND_INLINE int update_states(const std::array<const SoilMaterial*, kBatch>& soil, int count,
                                   SoilState<D, BatchLanes>& states, const BatchLanes& n,
                                   const Gradient<D, BatchLanes>& l, double dt, const BatchLanes& hoop) {
  const Strain<D, BatchLanes> strains = soil_update::turn<D, BatchLanes>(states, l, dt, hoop);
  bool same = true;
  for (int k = 1; k < count; ++k) same = same && soil[k] == soil[0];
  if (same)
    return with_law(
        soil[0]->law, [&](const auto& law) __attribute__((always_inline)) {
          return soil_update::all_lanes_of<D>(law, count, states, strains, n);
        });
  int held = 0;
  for (int k = 0; k < count; ++k)
    held += with_law(soil[k]->law,
                     [&](const auto& law) { return soil_update::one_lane<D>(law, k, states, strains, n); });
  return held;
}

}  // namespace quicksand
