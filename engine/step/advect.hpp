#pragma once
// What both phases do when their points take the faces' velocities.

#include <cstddef>

#include "engine/grid/window_rows.hpp"
#include "engine/step/batches.hpp"
#include "engine/step/move_point.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// Where one phase's members are among the four of FaceSpeeds.
struct SpeedMembers {
  int old, now;
};
inline constexpr SpeedMembers kSoilSpeeds{0, 1}, kWaterSpeeds{2, 3};
static_assert(offsetof(FaceSpeeds, soil) == 1 * sizeof(double) &&
              offsetof(FaceSpeeds, water_old) == 2 * sizeof(double) &&
              offsetof(FaceSpeeds, water) == 3 * sizeof(double) && sizeof(FaceSpeeds) == 4 * sizeof(double));

/// Component d of a phase's velocity on the window of a cell at the start and the end of the step, m/s, on
/// node x along the component's own axis, y and z along the others: where it lies, or with folds gathered.
template <SpeedMembers members, int d, int D>
class VelocityWindow {
  using Rows = WindowRows<d, D>;

 public:
  QUICKSAND_INLINE VelocityWindow(const State<D>& s, const CellWindow<D>& window) {
    if (window.open()) {
      const auto first = first_of_rows<d>(s.grid, window, s.speeds[d].data());
      each<Rows::count>([&](auto r) __attribute__((always_inline)) { row_[r] = &first[r]->soil_old; });
    } else {
      gather(s, window);
      each<Rows::count>([&](auto r) __attribute__((always_inline)) { row_[r] = &gathered_[16 * r]; });
    }
  }
  VelocityWindow(const VelocityWindow&) = delete;  // its rows may lie in it
  QUICKSAND_INLINE double old(auto x, auto y, auto z) const { return row(x, y, z)[members.old]; }
  QUICKSAND_INLINE double now(auto x, auto y, auto z) const { return row(x, y, z)[members.now]; }

 private:
  QUICKSAND_INLINE const double* row(auto x, auto y, auto z) const {
    constexpr int place = Rows::place(x + 4 * (y + 3 * z));
    return row_[place / 4] + place % 4 * 4;
  }
  void gather(const State<D>& s, const CellWindow<D>& window) {
    window.faces(d, [&](int node, int face, double sign) {
      const double* of = &s.speeds[d][face].soil_old;
      double* to = &gathered_[4 * Rows::place(node)];
      to[members.old] = sign * of[members.old];
      to[members.now] = sign * of[members.now];
    });
  }
  std::array<const double*, Rows::count> row_;  ///< FaceSpeeds, one after the other
  std::array<double, 16 * Rows::count> gathered_;
};

/// On the windows of two cells, in the lanes of the points of each.
template <class Window, int D>
struct PairedWindow {
  const PointBatch<D>& batch;
  Window first, second;
  QUICKSAND_INLINE BatchLanes old(auto x, auto y, auto z) const {
    return batch.by_cell(first.old(x, y, z), second.old(x, y, z));
  }
  QUICKSAND_INLINE BatchLanes now(auto x, auto y, auto z) const {
    return batch.by_cell(first.now(x, y, z), second.now(x, y, z));
  }
};

/// f(d, velocities) for all components, d as a type with the number as `value`.
template <SpeedMembers members, int D, class F>
QUICKSAND_INLINE void for_velocities(const State<D>& s, const PointBatch<D>& batch, const BatchWindows<D>& at,
                                     F&& f) {
  for_components<D>([&](auto d) __attribute__((always_inline)) {
    using Window = VelocityWindow<members, d, D>;
    if constexpr (PointBatch<D>::kPairs)
      f(d, PairedWindow<Window, D>{batch, Window(s, at.window[0]), Window(s, at.window[1])});
    else
      f(d, Window(s, at.window[0]));
  });
}
/// Their sums for a batch's points, one by one.
template <int d, int D, class Kernel, class Velocity>
QUICKSAND_INLINE BatchLanes old_value(const Kernel& kernel, const Velocity& v) {
  return window_value<d, D>(
      kernel, [&](auto x, auto y, auto z) __attribute__((always_inline)) { return v.old(x, y, z); });
}
template <int d, int D, class Kernel, class Velocity>
QUICKSAND_INLINE BatchLanes new_value(const Kernel& kernel, const Velocity& v) {
  return window_value<d, D>(
      kernel, [&](auto x, auto y, auto z) __attribute__((always_inline)) { return v.now(x, y, z); });
}
/// With second(nodes, i) in place of the derivatives.
template <int d, int D, class Kernel, class Velocity, class Second>
QUICKSAND_INLINE WindowSum<D> new_sum(const Kernel& kernel, const Velocity& v, const Second& second) {
  return window_sum<d, D>(
      kernel, [&](auto x, auto y, auto z) __attribute__((always_inline)) { return v.now(x, y, z); }, second);
}

/// FLIP with a little PIC: the point keeps its own velocity plus the grid's change, and relaxes to the
/// grid's velocity at `pic_rate`, a rate so that the damping does not depend on the time step. The affine
/// transfer takes the grid's velocity as it is (`pic` = 1): what PIC would lose is in the gradient.
template <class T>
QUICKSAND_INLINE T mix(const T& own, const T& before, const T& after, double pic) {
  return (1 - pic) * (own + after - before) + pic * after;
}

/// Factor of node i in place of its weight's derivative, in what a face's velocity adds to the gradient that
/// a point carries in the affine transfer, cells × 1/m: see affine_weight.
template <class Shape>
struct AffineFactor {
  template <class Nodes>
  QUICKSAND_INLINE BatchLanes operator()(const Nodes& nodes, int i) const {
    if constexpr (std::is_same_v<Shape, LinearHat>)
      return nodes.dw[i];
    else
      return nodes.w[i] * nodes.arm(i) / QuadraticSpline::spread;
  }
};

/// The gradient of component d that the affine transfer keeps.
template <class Shape, int d, int D, class Kernel, class Velocity>
QUICKSAND_INLINE void put_gradient(const Grid<D>& grid, const PointBatch<D>& batch, const Kernel& kernel,
                                   const Velocity& v, PointSet<D>& set) {
  const WindowSum<D> sum = new_sum<d, D>(kernel, v, AffineFactor<Shape>{});
  for (int j = 0; j < D; ++j) {
    const Kept<> slope = grid.inverse_h * sum.slope[j];
    for (int k = 0; k < batch.count; ++k) set.affine[batch.point[k]][d][axis_of(d, j)] = slope[k];
  }
}

/// Moves points by `way`; returns how many a wall stopped.
template <int D>
QUICKSAND_INLINE int move_batch(const Grid<D>& grid, const Walls<D>& walls, const PointBatch<D>& batch,
                                const BatchWindows<D>& windows, std::array<BatchLanes, D>& x,
                                const std::array<BatchLanes, D>& way) {
  if (windows.open()) {
    for (int d = 0; d < D; ++d) x[d] += way[d];
    return 0;
  }
  int stopped = 0;
  std::array<Kept<>, D> places, ways;
  for (int d = 0; d < D; ++d) places[d] = x[d], ways[d] = way[d];
  for (int k = 0; k < batch.count; ++k) {
    Vec<D> at, by;
    for (int d = 0; d < D; ++d) at[d] = places[d][k], by[d] = ways[d][k];
    stopped += move_point<D>(grid, walls, windows.home[batch.cell_of(k)], at, by);
    for (int d = 0; d < D; ++d) places[d][k] = at[d];
  }
  for (int d = 0; d < D; ++d) x[d] = places[d].lanes();
  return stopped;
}

}  // namespace quicksand
