#pragma once
// Faces → grains: velocity, strain and stress, porosity, position.

#include <bit>

#include "engine/step/advect.hpp"
#include "engine/step/point_totals.hpp"

namespace quicksand {

/// Velocities and velocity gradients of a batch of soil points after the step.
template <int D>
struct SoilMotion {
  std::array<BatchLanes, D> v, way;  ///< m/s, m
  Gradient<D, BatchLanes> l;         ///< 1/s
};

template <class S, int D>
QUICKSAND_INLINE SoilMotion<D> soil_motion(State<D>& s, const BatchWindows<D>& windows,
                                           const CellKernel<D, typename S::Shape>& kernel,
                                           const PointBatch<D>& batch, double dt, double pic) {
  SoilMotion<D> motion;
  motion.v = batch.get(s.soil.v);
  for_velocities<kSoilSpeeds>(
      s, batch, windows, [&](auto d, const auto& grid) __attribute__((always_inline)) {
        const BatchLanes before = old_value<d, D>(kernel, grid);
        const WindowSum<D> after = new_sum<d, D>(
            kernel, grid,
            [](const auto& nodes, int i) __attribute__((always_inline)) { return nodes.dw[i]; });
        motion.v[d] = mix(motion.v[d], before, after.value, pic);
        motion.way[d] = dt * after.value;
        for (int j = 0; j < D; ++j) motion.l[d][axis_of(d, j)] = s.grid.inverse_h * after.slope[j];
        if constexpr (S::affine) put_gradient<typename S::Shape, d, D>(s.grid, batch, kernel, grid, s.soil);
      });
  return motion;
}

/// Dˢn/Dt = (1−n) ∇·vˢ, integrated: the grains' volume stays. A step that turns the soil has ∇·vˢ < 0, as
/// its chords lead inward of their arcs; the determinant knows. `held` counts those kept within bounds.
template <int D>
QUICKSAND_INLINE BatchLanes strained_porosity(const BatchLanes& before, const BatchLanes& stretch, int count,
                                              long& held) {
  const BatchLanes least = all_lanes<BatchLanes>(0.1);
  const BatchLanes exact = 1.0 - (1.0 - before) / where(stretch > least, stretch, least);
  const BatchLanes n =
      clamped<BatchLanes>(exact, all_lanes<BatchLanes>(kMinRoom), all_lanes<BatchLanes>(kMaxPorosity));
  held += std::popcount(bits_of(n != exact) & first_bits(count));
  return n;
}

/// The steps that the points allow, with `touching` their porosities. Where all are of one soil of one
/// stiffness, `porosities` tell them at the end of the block.
template <int D>
QUICKSAND_INLINE void allow_steps(const State<D>& s, const PointBatch<D>& batch,
                                  const BatchWindows<D>& windows,
                                  const std::array<const SoilMaterial*, kBatch>& material,
                                  const SoilState<D, BatchLanes>& now, const BatchLanes& touching,
                                  Totals<D>& totals, PorosityRanges& porosities) {
  const std::array<bool, 2> confined{s.cell[windows.home[0]].confined, s.cell[windows.home[1]].confined};
  if (s.constants.one_stiffness()) {
    porosities.add(batch, touching, batch.by_cell(confined[0], confined[1]));
    return;
  }
  for (int k = 0; k < batch.count; ++k) {
    const double n = touching[k], modulus = material[k]->template constrained_modulus<D>(lane_of(now, k), n);
    const StepLimit& limit = s.constants.step_limits[s.soil.soil[batch.point[k]]];
    totals.soil_limit = std::min(
        totals.soil_limit, confined[batch.cell_of(k)] ? limit.saturated(n, modulus) : limit.dry(n, modulus));
    if (s.constants.explicit_pressure)
      totals.fast_wave_limit = std::min(totals.fast_wave_limit, limit.fast_wave(n, modulus));
  }
}

/// Stress and what else the law keeps, and the steps that the points allow.
template <class S, int D>
QUICKSAND_INLINE BatchLanes update_soil(State<D>& s, const PointBatch<D>& batch,
                                        const BatchWindows<D>& windows, const Gradient<D, BatchLanes>& l,
                                        double dt, const BatchLanes& hoop, Totals<D>& totals,
                                        PorosityRanges& porosities) {
  SoilPoints<D>& soil = s.soil;
  std::array<const SoilMaterial*, kBatch> material;
  material.fill(&s.constants.soils.front());
  BatchLanes max_porosity = all_lanes<BatchLanes>(material[0]->max_porosity);
  if (s.constants.soils.size() > 1) {
    for (int k = 0; k < kBatch; ++k) material[k] = &s.constants.soils[soil.soil[batch.point[k]]];
    max_porosity = lanes_of<kBatch>([&](int k) { return material[k]->max_porosity; });
  }
  const BatchLanes before = batch.get(soil.porosity);
  const BatchLanes n = strained_porosity<D>(before, volume_ratio<D, BatchLanes>(l, dt) * (1.0 + dt * hoop),
                                            batch.count, totals.interventions.clamped_values);
  batch.put(n, soil.porosity);
  SoilState<D, BatchLanes> now{batch.get(soil.stress), batch.get(soil.plastic_strain), {}};
  if (!soil.preconsolidation.empty()) now.preconsolidation = batch.get(soil.preconsolidation);
  const BatchLanes plastic_strain = now.plastic_strain, preconsolidation = now.preconsolidation;
  totals.interventions.clamped_values += update_states<D>(material, batch.count, now, before, l, dt, hoop);
  const auto apart = n > max_porosity;  // grains that do not touch
  if (any_of(apart, batch.count)) {
    for (BatchLanes& component : now.stress) component = where(apart, BatchLanes{}, component);
    now.plastic_strain = where(apart, plastic_strain, now.plastic_strain);
    now.preconsolidation = where(apart, preconsolidation, now.preconsolidation);
  }
  batch.put(now.stress, soil.stress);
  batch.put(now.plastic_strain, soil.plastic_strain);
  if (!soil.preconsolidation.empty()) batch.put(now.preconsolidation, soil.preconsolidation);
  // Grains that do not touch may touch again in the next step.
  allow_steps<D>(s, batch, windows, material, now, where(apart, max_porosity, n), totals, porosities);
  return trace(now.stress);
}

template <class S, int D>
void soil_from_faces(State<D>& s, const PointBatch<D>& batch, double dt, double pic, Totals<D>& totals,
                     MotionTotals<D>& motion_totals, PorosityRanges& porosities) {
  std::array<BatchLanes, D> x = batch.get(s.soil.x);
  CellKernel<D, typename S::Shape> kernel;
  kernel.find(s.grid, batch.places(), x);
  const BatchWindows<D> windows(s.grid, s.soil_walls, batch);
  const SoilMotion<D> motion = soil_motion<S, D>(s, windows, kernel, batch, dt, pic);
  BatchLanes hoop{};  // 1/s, v_r/r
  if constexpr (S::axial) hoop = motion.way[0] / (dt * x[0]);
  totals.interventions.clipped_points += move_batch<D>(s.grid, s.soil_walls, batch, windows, x, motion.way);
  batch.put(x, s.soil.x);
  batch.put(motion.v, s.soil.v);
  const BatchLanes stress = update_soil<S, D>(s, batch, windows, motion.l, dt, hoop, totals, porosities);
  motion_totals.add(batch, s.soil.mass, motion.v, stress);
}

}  // namespace quicksand
