#pragma once
// Water → faces and cells: mass, momentum, volume.

#include "engine/step/mass_to_faces.hpp"

namespace quicksand {

template <class S, int D>
void water_to_faces(State<D>& s, const PointBatch<D>& batch) {
  CellKernel<D, typename S::Shape> kernel;
  kernel.find(s.grid, batch.places(), batch.get(s.water.x));
  const BatchWindows<D> windows(s.grid, s.water_walls, batch);
  const BatchLanes mass = batch.get(s.water.mass);
  const std::array<BatchLanes, D> v = batch.get(s.water.v);
  const NodesByPoint<2> faces = by_point(kernel.face[0].w, kernel.face[0].w),
                        centers = by_point(kernel.center[0].w, kernel.center[0].w);
  for_components<D>([&](auto d) __attribute__((always_inline)) {
    const MassRows<S, d, D> rows(kernel, mass, v[d], turning_of<S, d>(s.water, batch, mass, s.grid.h));
    const NodesByPoint<2>& nodes = d == 0 ? faces : centers;
    windows.each(
        batch, [&](const auto& window, int from, int to) __attribute__((always_inline)) {
          add_to_faces<d>(s.grid, window, rows.sums(nodes, from, to), s.sums[d].water,
                          [&](int face, double mirrored) { s.image[d][face].water += 2 * mirrored; });
        });
  });
  const NodesByPoint<1> once = by_point(kernel.center[0].w);
  const Kept<> volume = mass / s.constants.water_density;
  const auto weight = row_weights<0, D>(kernel);
  const auto filled = [&](int k) __attribute__((always_inline)) { return once[k] * volume[k]; };
  const auto add = [&](int cell, const double* of) { s.cell_sums[cell].water += *of; };
  windows.each(
      batch, [&](const auto& window, int from, int to) __attribute__((always_inline)) {
        for_centers_of<1>(window, sum_points<1>(from, to, Term(weight, filled)), add);
      });
}

}  // namespace quicksand
