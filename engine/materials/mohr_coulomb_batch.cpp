// The law for several points at once: return_map in lanes. What is cut by a largest tension goes through
// return_map one by one.

#include <array>
#include <cmath>

#include "engine/materials/mohr_coulomb.hpp"
#include "engine/materials/principal_lanes.hpp"

namespace quicksand {
namespace {

using Principals = std::array<BatchLanes, 3>;

/// Where trial stresses end.
struct Returned {
  Principals stress;  ///< Pa
  BatchLanes shear;   ///< –, √(2/3 e:e) of the plastic strain's deviator e
};

/// a where the mask is true, else b.
template <class Mask>
QUICKSAND_INLINE Returned either(const Mask& mask, const Returned& a, const Returned& b) {
  const auto chosen = [&](int i) __attribute__((always_inline)) {
    return where(mask, a.stress[i], b.stress[i]);
  };
  return {{chosen(0), chosen(1), chosen(2)}, where(mask, a.shear, b.shear)};
}

/// Pa, over yield on the face of a larger and a smaller principal stress.
QUICKSAND_INLINE BatchLanes excess(const MohrCoulomb& law, const BatchLanes& larger,
                                   const BatchLanes& smaller, const BatchLanes& cohesion) {
  return larger * (1 + law.sin_phi) - smaller * (1 - law.sin_phi) - 2 * law.cos_phi * cohesion;
}

QUICKSAND_INLINE Returned onto_face(const FaceReturn& face, const Principals& trial,
                                    const BatchLanes& gamma) {
  const auto moved = [&](int i) __attribute__((always_inline)) { return trial[i] - gamma * face.drop[i]; };
  return {{moved(0), moved(1), moved(2)}, gamma * face.shear};
}

/// `f` and `f2`: Pa, over yield on the face σ1–σ3 and on the other one.
QUICKSAND_INLINE Returned onto_edge(const FaceReturn& face, const EdgeReturn& edge, const Principals& trial,
                                    const BatchLanes& f, const BatchLanes& f2) {
  const BatchLanes one = edge.own * f - edge.other * f2, two = edge.own * f2 - edge.other * f;
  const auto moved = [&](int i) __attribute__((always_inline)) {
    return trial[i] - one * face.drop[i] - two * edge.drop[i];
  };
  const BatchLanes square = face.shear * face.shear * (one * one + two * two) + 2 * edge.shear * one * two;
  return {{moved(0), moved(1), moved(2)}, square_root(where(square > 0, square, BatchLanes{}))};
}

QUICKSAND_INLINE Returned onto_apex(const Elastic& elastic, const Principals& trial, const BatchLanes& apex) {
  const auto& [s1, s2, s3] = trial;
  const BatchLanes a = s1 - s2, b = s2 - s3, c = s1 - s3;  // s:s = (a² + b² + c²)/3, e = s/2G
  return {{apex, apex, apex}, square_root(a * a + b * b + c * c) * (std::sqrt(2.0) / (6 * elastic.shear))};
}

/// Whether σ1 ≥ σ2 ≥ σ3 does not hold.
QUICKSAND_INLINE auto unsorted(const Principals& s, const BatchLanes& tolerance) {
  return (s[0] < s[1] - tolerance) | (s[1] < s[2] - tolerance);
}

/// What the return onto the face, `r`, becomes where it left the face: as return_to_pyramid.
QUICKSAND_INLINE Returned onto_pyramid(const MohrCoulombLaw& law, const Principals& trial,
                                       const BatchLanes& cohesion, const BatchLanes& tolerance, Returned r) {
  const auto& [s1, s2, s3] = trial;
  const MohrCoulomb& peak = law.peak;
  const BatchLanes f = excess(peak, s1, s3, cohesion);
  const Returned compression =
                     onto_edge(law.face, law.face.compression, trial, f, excess(peak, s2, s3, cohesion)),
                 extension =
                     onto_edge(law.face, law.face.extension, trial, f, excess(peak, s1, s2, cohesion));
  r = either(unsorted(r.stress, tolerance), either(r.stress[1] > r.stress[0], compression, extension), r);
  if (peak.sin_phi <= 0) return r;
  const BatchLanes apex = cohesion * (peak.cos_phi / peak.sin_phi);
  return either(unsorted(r.stress, tolerance) | (r.stress[2] > apex + tolerance),
                onto_apex(law.elastic, trial, apex), r);
}

/// return_map in the chosen lanes; `done` becomes 1 where it yields, else 0.
void return_alone(const MohrCoulombLaw& law, const Principals& trial, const BatchLanes& cohesion,
                  unsigned chosen, Returned& r, Kept<>& done) {
  Kept<> s1 = r.stress[0], s2 = r.stress[1], s3 = r.stress[2], shear = r.shear;
  MohrCoulomb now = law.peak;
  for (int k = 0; k < kBatch; ++k) {
    if (!(chosen >> k & 1)) continue;
    now.cohesion = cohesion[k];
    const MohrCoulombReturn one = return_map(now, law.elastic, {trial[0][k], trial[1][k], trial[2][k]});
    done[k] = one.region != YieldRegion::elastic;
    s1[k] = one.stress[0], s2[k] = one.stress[1], s3[k] = one.stress[2], shear[k] = plastic_shear(one);
  }
  r = {{s1.lanes(), s2.lanes(), s3.lanes()}, shear.lanes()};
}

}  // namespace

template <int D>
int MohrCoulombLaw::update_batch(SoilState<D, BatchLanes>& state, const Strain<D, BatchLanes>& strain,
                                 const BatchLanes& /*porosity*/, int count) const {
  elastic.stretch(state.stress, strain);
  const BatchLanes c = cohesion(state.plastic_strain), zero{};
  const auto yields = may_yield<D>(c, state);
  if (!any_of(yields, count)) return 0;

  const PrincipalLanes<D> principal(state.stress);
  const auto& [s1, s2, s3] = principal.value;
  const BatchLanes gamma = face.compliance * excess(peak, s1, s3, c);
  Returned r = onto_face(face, principal.value, gamma);
  const BatchLanes scale = where(s1 < zero, -s1, s1) + where(s3 < zero, -s3, s3) + c;
  const auto plastic = yields & (gamma > face.compliance * 1e-14 * scale);
  auto returned =
      plastic & (r.stress[0] >= r.stress[1]) & (r.stress[1] >= r.stress[2]) & (r.stress[0] <= peak.tension);
  if (peak.sin_phi > 0) returned = returned & (r.stress[2] * peak.sin_phi <= peak.cos_phi * c);

  // Lanes that yield by the bounds of their principal stresses alone stay as they are.
  const auto beyond = plastic | (s1 > peak.tension);
  if (const unsigned left = bits_of(beyond) & ~bits_of(returned) & first_bits(count)) {
    r = either(plastic, onto_pyramid(*this, principal.value, c, 1e-12 * scale, r),
               Returned{principal.value, zero});
    Kept<> done = where(plastic, zero + 1.0, zero);
    if (const unsigned cut = bits_of(r.stress[0] > peak.tension) & left)
      return_alone(*this, principal.value, c, cut, r, done);
    returned = done.lanes() > 0;
  }
  state.plastic_strain += where(returned, r.shear, zero);
  const Stress<D, BatchLanes> stress = principal.with(r.stress);
  for (std::size_t i = 0; i < stress.size(); ++i)
    state.stress[i] = where(returned, stress[i], state.stress[i]);
  return 0;
}

template int MohrCoulombLaw::update_batch<2>(SoilState<2, BatchLanes>&, const Strain<2, BatchLanes>&,
                                             const BatchLanes&, int) const;
template int MohrCoulombLaw::update_batch<3>(SoilState<3, BatchLanes>&, const Strain<3, BatchLanes>&,
                                             const BatchLanes&, int) const;

}  // namespace quicksand
