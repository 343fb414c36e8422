#pragma once
// What the tests of the step ask of a state.

#include <algorithm>
#include <cmath>

#include "engine/run/setup.hpp"
#include "engine/run/watch.hpp"
#include "engine/step/step.hpp"
#include "tests/engine/small_scene.hpp"

namespace quicksand::test {

template <int D, class F>
StepReport<D> advance_times(State<D>& s, int steps, double dt, F&& after) {
  StepReport<D> report;
  for (int i = 0; i < steps; ++i) {
    report = advance(s, dt);
    after(report);
  }
  return report;
}
template <int D>
StepReport<D> advance_times(State<D>& s, int steps, double dt) {
  return advance_times(s, steps, dt, [](const auto&) {});
}

/// Largest difference of the pressure in wet cells from ρw g × depth below `level`, of ρw g × h.
template <int D>
double pressure_error(const State<D>& s, double level) {
  const double g = -s.constants.gravity[kUp], weight = s.constants.water_density * g;
  double worst = 0;
  for_each_cell(s.grid, [&](int i, const Cell<D>& c) {
    if (!s.cell[i].wet()) return;
    const double expected = weight * (level - s.grid.center(c)[kUp]);
    worst = std::max(worst, std::abs(s.pressure[i] - expected) / std::max(expected, weight * s.grid.h));
  });
  return worst;
}

template <int D>
int wet_cells(const State<D>& s) {
  int n = 0;
  for_each_cell(s.grid, [&](int i, const Cell<D>&) { n += s.cell[i].wet(); });
  return n;
}

/// Sand in a corner, water beside and above it, that flows and settles as soon as it is let go.
inline Scene collapse(double h = 0.05) {
  Scene s = plane(1, 0.8, h);
  add_body(s, "bank", BodyKind::saturated_soil, {0, 0, 0}, {0.4, 0.4, 0});
  add_body(s, "pool", BodyKind::water, {0.4, 0, 0}, {0.7, 0.6, 0});
  add_body(s, "dry", BodyKind::soil, {0.8, 0, 0}, {1, 0.2, 0});
  return s;
}

}  // namespace quicksand::test
