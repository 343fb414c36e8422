// How fast the water passes the grains of soils whose drag asks for it (Ergun).

#include <cmath>

#include "engine/grid/stencil.hpp"
#include "engine/step/phases.hpp"
#include "engine/threads/chunks.hpp"

namespace quicksand {
namespace {

/// Velocity of the water past a point's grains after the last step, m/s.
template <class Shape, int D>
double relative_speed(const State<D>& s, const Vec<D>& x, bool fixed) {
  const PointKernel<D, Shape> kernel(s.grid, x);
  double square = 0;
  for (int d = 0; d < D; ++d) {
    double v = 0;
    for_faces(s.grid, s.water_walls, kernel, d, [&](int face, double w, double sign, const Vec<D>&) {
      v += sign * w * s.speeds[d][face].water;
    });
    if (!fixed)
      for_faces(s.grid, s.soil_walls, kernel, d, [&](int face, double w, double sign, const Vec<D>&) {
        v -= sign * w * s.speeds[d][face].soil;
      });
    square += v * v;
  }
  return std::sqrt(square);
}

/// The drag of a step takes the speed of the steps before. Where a pressure gradient drives the flow, the
/// last speed alone would swing: too fast gives too much drag gives too slow, undamped where inertia rules
/// the drag. The mean with the speed used before settles in a few steps, from a sudden start too, and has the
/// same limit.
template <class Shape, int D>
void follow(const State<D>& s, SoilPoints<D>& soil, bool fixed) {
  for_chunks(soil.discharge.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      if (!s.constants.soils[soil.soil[p]].drag.follows_speed()) continue;
      const double now = soil.porosity[p] * relative_speed<Shape, D>(s, soil.x[p], fixed);
      soil.discharge[p] = 0.5 * (soil.discharge[p] + now);
    }
  });
}

}  // namespace

template <int D>
void follow_discharge(State<D>& s) {
  with_kernel(s.constants.kernel, [&](auto shape) {
    follow<decltype(shape)>(s, s.soil, false);
    follow<decltype(shape)>(s, s.fixed, true);
  });
  if (!s.fixed.discharge.empty()) measure_fixed(s);
}

template void follow_discharge<2>(State<2>&);
template void follow_discharge<3>(State<3>&);

}  // namespace quicksand
