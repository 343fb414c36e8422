#pragma once
// Faces → water: velocity and position. Points move by the midpoint rule; Euler's way leads out of every
// bend. Half the way by the kernel's own velocity is near enough for the middle. Drops fall straight on.

#include "engine/grid/stencil.hpp"
#include "engine/step/advect.hpp"
#include "engine/step/point_totals.hpp"

namespace quicksand {

/// Distance above the water surface, in cells, from which a drop falls freely instead of moving with it.
/// Points of a surface at rest lie a quarter of a cell below it.
constexpr double kFreeHeight = 0.25;

/// Which of a batch's points fall freely.
template <int D, class Kernel>
QUICKSAND_INLINE std::array<bool, kBatch> falling(const State<D>& s, const PointBatch<D>& batch,
                                                  const BatchWindows<D>& at, const Kernel& kernel) {
  std::array<bool, kBatch> falls{};
  const std::array<bool, 2> confined{s.cell[at.home[0]].confined, s.cell[at.home[1]].confined};
  if (confined[0] && confined[1]) return falls;
  std::array<std::array<double, CellWindow<D>::kCenters>, 2> depth;
  for (int c = 0; c < 2; ++c)
    at.window[c].centers([&](int node, int cell) { depth[c][node] = s.cell[cell].depth; });
  BatchLanes at_point{};
  for (int z = 0; z < CellWindow<D>::kLast; ++z)
    for (int y = 0; y < 3; ++y) {
      BatchLanes row{};
      for (int x = 0; x < 3; ++x) {
        const int node = x + 3 * (y + 3 * z);
        row += kernel.center[0].w[x] * batch.by_cell(depth[0][node], depth[1][node]);
      }
      at_point += (D == 2 ? kernel.center[1].w[y] : kernel.center[1].w[y] * kernel.center[D - 1].w[z]) * row;
    }
  for (int k = 0; k < batch.count; ++k) falls[k] = at_point[k] < -kFreeHeight && !confined[batch.cell_of(k)];
  return falls;
}

/// New velocity of a drop and its way: near the surface it is not lifted with the water there.
template <class S, int D>
void fall(State<D>& s, std::uint32_t p, double dt, double pic, Vec<D>& v, Vec<D>& way, Totals<D>& totals) {
  const PointKernel<D, typename S::Shape> kernel(s.grid, s.water.x[p]);
  for (int d = 0; d < D; ++d) {
    double carried = 0, before = 0, after = 0;
    Vec<D> slope{};
    for_faces(s.grid, s.water_walls, kernel, d, [&](int face, const FaceWeight<D>& weight, double sign) {
      const FaceSpeeds& f = s.speeds[d][face];
      double at_face = f.water;
      if (s.flow[d][face].wet > 1) {
        const double lift = f.water - f.water_old - dt * s.constants.fall(d);
        at_face -= lift;
        carried += sign * weight.w * lift;
      }
      after += sign * weight.w * at_face;
      before += sign * weight.w * f.water_old;
      if constexpr (S::affine) {
        const Vec<D> a = affine_weight<typename S::Shape>(weight, s.grid.inverse_h);
        for (int j = 0; j < D; ++j) slope[j] += sign * at_face * a[j];
      }
    });
    if constexpr (S::affine) s.water.affine[p][d] = slope;
    v[d] = mix(s.water.v[p][d], before, after, pic);
    way[d] = dt * after;
    totals.let_go[d] -= s.water.mass[p] * carried;
  }
}

/// Way of one point by the velocity that carries water, from the middle of its way.
template <class Shape, int D>
Vec<D> carried_way(const State<D>& s, const Vec<D>& middle, double dt) {
  const PointKernel<D, typename Shape::Mover> mover(s.grid, middle);
  Vec<D> way{};
  for (int d = 0; d < D; ++d)
    for_faces(s.grid, s.water_walls, mover, d, [&](int face, double w, double sign, const Vec<D>&) {
      way[d] += dt * sign * w * s.speeds[d][face].water;
    });
  return way;
}

template <class S, int D>
void water_from_faces(State<D>& s, const PointBatch<D>& batch, double dt, double pic, Totals<D>& totals,
                      MotionTotals<D>& motion_totals) {
  using Shape = typename S::Shape;
  using Lanes = std::array<BatchLanes, D>;
  Lanes x = batch.get(s.water.x), v = batch.get(s.water.v), way;
  CellKernel<D, Shape> kernel;
  kernel.find(s.grid, batch.places(), x);
  const BatchWindows<D> windows(s.grid, s.water_walls, batch);
  for_velocities<kWaterSpeeds>(
      s, batch, windows, [&](auto d, const auto& grid) __attribute__((always_inline)) {
        const BatchLanes after = new_value<d, D>(kernel, grid);
        v[d] = mix(v[d], old_value<d, D>(kernel, grid), after, pic);
        way[d] = dt * after;
        if constexpr (S::affine) put_gradient<Shape, d, D>(s.grid, batch, kernel, grid, s.water);
      });
  const std::array<bool, kBatch> falls = falling(s, batch, windows, kernel);
  for (int k = 0; k < batch.count; ++k) {
    if (!falls[k]) continue;
    Vec<D> new_v, new_way;
    fall<S, D>(s, batch.point[k], dt, pic, new_v, new_way, totals);
    for (int d = 0; d < D; ++d) set_lane(v[d], k, new_v[d]), set_lane(way[d], k, new_way[d]);
  }
  batch.put(v, s.water.v);
  motion_totals.add(batch, s.water.mass, v, BatchLanes{});

  Lanes middle = x, half;
  for (int d = 0; d < D; ++d) half[d] = 0.5 * way[d];
  move_batch<D>(s.grid, s.water_walls, batch, windows, middle, half);
  CellKernel<D, typename Shape::Mover> mover;
  mover.find(s.grid, batch.places(), middle);
  Lanes carried;
  for_velocities<kWaterSpeeds>(
      s, batch, windows, [&](auto d, const auto& grid) __attribute__((always_inline)) {
        carried[d] = dt * new_value<d, D>(mover, grid);
      });
  for (int k = 0; k < batch.count; ++k) {
    Vec<D> at;
    for (int d = 0; d < D; ++d) at[d] = middle[d][k];
    if (falls[k]) {
      for (int d = 0; d < D; ++d) set_lane(carried[d], k, way[d][k]);
    } else if (s.grid.cell_of(at) != batch.cell[batch.cell_of(k)]) {
      const Vec<D> other = carried_way<Shape, D>(s, at, dt);
      for (int d = 0; d < D; ++d) set_lane(carried[d], k, other[d]);
    }
  }
  totals.interventions.clipped_points += move_batch<D>(s.grid, s.water_walls, batch, windows, x, carried);
  batch.put(x, s.water.x);
}

}  // namespace quicksand
