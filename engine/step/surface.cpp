// Where the water surface is (see gaps.cpp for what is none), how much room cells have, and how far volumes
// have drifted.

#include <cmath>

#include "engine/step/phases.hpp"
#include "engine/step/scheme.hpp"

namespace quicksand {
namespace {

/// Signed distance (cells) from a plane water surface at which a kernel is filled to `fill`: the inverse of
/// its integral, which is 1 − (1−ξ)²/2 for a hat at ξ ≥ 0.
double depth_of_fill(LinearHat, double fill) {
  if (fill < 0.5) return -depth_of_fill(LinearHat{}, 1 - fill);
  return 1 - std::sqrt(2 * std::max(0.0, 1 - fill));
}

/// The quadratic spline's integral is ½ + ¾ξ − ξ³/3 for |ξ| ≤ ½ and 1 − (3/2−ξ)³/6 beyond.
double depth_of_fill(QuadraticSpline, double fill) {
  if (fill < 0.5) return -depth_of_fill(QuadraticSpline{}, 1 - fill);
  const double rest = 1 - fill;
  if (rest <= 0) return 1.5;
  if (rest <= 1.0 / 6) return 1.5 - std::cbrt(6 * rest);
  double xi = (fill - 0.5) / 0.75;
  for (int i = 0; i < 4; ++i)  // Newton; the slope stays ≥ ½ on this branch
    xi -= (0.5 + 0.75 * xi - xi * xi * xi / 3 - fill) / (0.75 - xi * xi);
  return xi;
}

}  // namespace

template <int D>
void find_surface(State<D>& s) {
  if (!s.has_water) return;
  s.blocks.all([&](int b) {
    s.blocks.cells(s.grid, b, false, [&](int i, const Cell<D>&) {
      const CellSums& sums = s.cell_sums[i];
      CellState& c = s.cell[i];
      c = {};
      if (s.water_walls.blocked(i)) return;
      const double volume = s.volume.cell(i);
      c.n = std::max(1 - sums.grains / volume, kMinRoom);
      c.fill = fill_of(sums.water / volume, sums.grains / volume, sums.soil_bulk / volume);
      c.depth = with_kernel(s.constants.kernel, [&](auto shape) { return depth_of_fill(shape, c.fill); });
      c.row = c.depth > kMinSurfaceDistance;
    });
  });
  close_gaps(s);
  // Drift is measured only where no air is in reach of the kernel.
  s.blocks.all([&](int b) {
    s.blocks.cells(s.grid, b, false, [&](int i, const Cell<D>&) {
      CellState& c = s.cell[i];
      if (!c.wet()) {
        s.pressure[i] = 0;
        return;
      }
      const double excess = (s.cell_sums[i].water + s.cell_sums[i].grains) / s.volume.cell(i) - 1;
      c.confined = true;
      for (int d = 0; d < D; ++d)
        for (int side : {0, 1}) {
          const int face = i + side * s.grid.stride[d], other = i + (2 * side - 1) * s.grid.stride[d];
          if (s.water_walls.closed(d, face) || s.cell[other].wet() || in_plate(s, d, face)) continue;
          if (!submerged(s, d, face)) c.confined = false;
        }
      if (excess > 0 || c.confined) c.excess = excess;
    });
  });
}

template void find_surface<2>(State<2>&);
template void find_surface<3>(State<3>&);

}  // namespace quicksand
