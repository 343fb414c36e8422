// The law for several points at once. Most returns end on the face σ1–σ3, for which there is a closed form;
// what is left goes through return_map one by one.

#include "engine/materials/mohr_coulomb.hpp"
#include "engine/materials/principal_lanes.hpp"

namespace quicksand {

template <int D>
int MohrCoulombLaw::update_batch(SoilState<D, BatchLanes>& state, const Strain<D, BatchLanes>& strain,
                                 const BatchLanes& /*porosity*/, int count) const {
  elastic.stretch(state.stress, strain);
  const BatchLanes c = cohesion(state.plastic_strain);
  const auto yields = may_yield<D>(c, state);
  if (!any_of(yields, count)) return 0;

  const PrincipalLanes<D> principal(state.stress);
  const auto& [s1, s2, s3] = principal.value;
  const BatchLanes gamma =
      face.compliance * (s1 * (1 + peak.sin_phi) - s3 * (1 - peak.sin_phi) - 2 * peak.cos_phi * c);
  BatchLanes r1 = s1 - gamma * face.drop[0], r2 = s2 - gamma * face.drop[1], r3 = s3 - gamma * face.drop[2];
  auto returned = yields & (gamma > 0) & (r1 >= r2) & (r2 >= r3) & (r1 <= peak.tension);
  if (peak.sin_phi > 0) returned = returned & (r3 * peak.sin_phi <= peak.cos_phi * c);
  state.plastic_strain += where(returned, gamma * face.shear, BatchLanes{});

  const unsigned left = bits_of(yields) & ~bits_of(returned) & first_bits(count);
  if (left != 0) {
    Kept<> k1 = r1, k2 = r2, k3 = r3, strained = state.plastic_strain, done = BatchLanes{};
    MohrCoulomb now = peak;
    for (int k = 0; k < count; ++k) {
      if (!(left >> k & 1)) continue;
      now.cohesion = c[k];
      const MohrCoulombReturn r = return_map(now, elastic, {s1[k], s2[k], s3[k]});
      if (r.region == YieldRegion::elastic) continue;
      k1[k] = r.stress[0], k2[k] = r.stress[1], k3[k] = r.stress[2];
      strained[k] += plastic_shear(r);
      done[k] = 1;
    }
    r1 = k1.lanes(), r2 = k2.lanes(), r3 = k3.lanes(), state.plastic_strain = strained.lanes();
    returned = returned | (done.lanes() > 0);
  }
  const Stress<D, BatchLanes> stress = principal.with({r1, r2, r3});
  for (std::size_t i = 0; i < stress.size(); ++i)
    state.stress[i] = where(returned, stress[i], state.stress[i]);
  return 0;
}

template int MohrCoulombLaw::update_batch<2>(SoilState<2, BatchLanes>&, const Strain<2, BatchLanes>&,
                                             const BatchLanes&, int) const;
template int MohrCoulombLaw::update_batch<3>(SoilState<3, BatchLanes>&, const Strain<3, BatchLanes>&,
                                             const BatchLanes&, int) const;

}  // namespace quicksand
