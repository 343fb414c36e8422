#include <cmath>
#include <numeric>

#include "engine/run/sampling.hpp"
#include "engine/run/watch.hpp"
#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

/// In more digits than are kept, so that the order of the points does not show.
double total(const std::vector<double>& mass) {
  return static_cast<double>(std::accumulate(mass.begin(), mass.end(), 0.0L));
}

template <int D, class F>
void each_set(const State<D>& s, F&& f) {
  f(s.soil), f(s.water);
}

void count(const Interventions& done, Ledger& l) {
  l.clipped_points = done.clipped_points;
  l.clamped_values = done.clamped_values;
  l.cut_steps = done.cut_steps;
  l.retries = done.retries;
}

}  // namespace

template <int D>
double LedgerKeeper<D>::potential(const State<D>& s) const {
  double e = 0;
  each_set(s, [&](const auto& set) {
    for (std::size_t p = 0; p < set.size(); ++p)
      for (int d = 0; d < D; ++d) e -= set.mass[p] * s.constants.gravity[d] * set.x[p][d];
  });
  return e;
}

template <int D>
LedgerKeeper<D>::LedgerKeeper(const Scene&, const State<D>& s) {
  ledger_.water_mass = ledger_.water_mass_initial = total(s.water.mass);
  ledger_.solid_mass = ledger_.solid_mass_initial = total(s.soil.mass) + total(s.fixed.mass);
  ledger_.water_volume = ledger_.water_volume_initial = water_volume(s);
  start_momentum_ = s.momentum;
  each_set(s, [&](const auto& set) {  // of the points, as that of bodies that move apart sums to nothing
    for (std::size_t p = 0; p < set.size(); ++p)
      for (int d = 0; d < D; ++d) driving_impulse_ += set.mass[p] * std::abs(set.v[p][d]);
  });
}

template <int D>
void LedgerKeeper<D>::add(const State<D>& s, const StepReport<D>& step) {
  Ledger& l = ledger_;
  count(s.interventions, l);
  l.water_in += step.exchange.water_in;
  l.water_out += step.exchange.water_out;
  l.soil_out += step.exchange.soil_out;
  l.energy_damped += step.damped;
  const double moving = step.moving_mass;
  double residual = 0, driving = 0;
  // About an axis what points radially has no resultant: the momentum upwards is balanced alone.
  for (int d = s.grid.axial ? kUp : 0; d < D; ++d) {
    const double impulse = moving * s.constants.gravity[d] * step.dt;
    driving += impulse * impulse + step.impulse_loads[d] * step.impulse_loads[d];
    l.impulse_gravity[d] += impulse;
    l.impulse_walls[d] += step.impulse_walls[d];
    l.impulse_loads[d] += step.impulse_loads[d];
    l.impulse_surface[d] += step.impulse_surface[d];
    l.impulse_flow[d] += step.exchange.momentum[d];
    l.impulse_damping[d] += step.impulse_damping[d];
    l.momentum_change[d] = step.momentum[d] - start_momentum_[d];
    const double open = l.momentum_change[d] - l.impulse_gravity[d] - l.impulse_walls[d] -
                        l.impulse_surface[d] - l.impulse_loads[d] - l.impulse_flow[d] - l.impulse_stages[d] -
                        l.impulse_damping[d] - l.impulse_removed[d];
    residual += open * open;
  }
  driving_impulse_ += std::sqrt(driving);
  l.momentum_residual = driving_impulse_ > 0 ? std::sqrt(residual) / driving_impulse_ : 0;
}

template <int D>
void LedgerKeeper<D>::add(const StageChange<D>& change) {
  ledger_.water_removed += change.removed.water;
  ledger_.soil_removed += change.removed.soil;
  for (int d = 0; d < D; ++d) {
    ledger_.impulse_stages[d] += change.impulse[d];
    ledger_.impulse_removed[d] -= change.removed.momentum[d];
  }
}

template <int D>
void LedgerKeeper<D>::measure(const State<D>& s, const StepReport<D>& step) {
  Ledger& l = ledger_;
  count(s.interventions, l);
  l.energy_kinetic = step.kinetic;
  l.energy_strain = strain_energy(s);
  l.water_mass = total(s.water.mass);
  l.solid_mass = total(s.soil.mass) + total(s.fixed.mass);
  l.water_volume = water_volume(s);
  l.energy_potential = potential(s);
  if (l.water_volume_initial <= 0) return;
  // What gaps finer than the cells took of the room at the start is no drift.
  const double held = water_held(s),
               gaps = l.water_volume_initial - l.water_mass_initial / s.constants.water_density;
  const double drift = (l.water_volume - held - gaps) / std::max(l.water_volume_initial, held);
  l.water_volume_drift_max = std::max(l.water_volume_drift_max, std::abs(drift));
  drift_ = drift;
}

template <int D>
void LedgerKeeper<D>::sampled() {
  Ledger& l = ledger_;
  drifts_.push_back(drift_);
  drift_sum_ += drift_;
  const std::size_t samples = drifts_.size(), first = samples / 2;
  if (first > (samples - 1) / 2) drift_sum_ -= drifts_[first - 1];
  l.water_volume_drift = drift_sum_ / static_cast<double>(samples - first);
}

template class LedgerKeeper<2>;
template class LedgerKeeper<3>;

}  // namespace quicksand
