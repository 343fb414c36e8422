#pragma once
// What both phases do when their points take the faces' velocities.

#include "engine/step/batches.hpp"
#include "engine/step/move_point.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// One phase's members of FaceSpeeds.
struct SpeedMembers {
  double FaceSpeeds::*old, FaceSpeeds::*now;
};
inline constexpr SpeedMembers kSoilSpeeds{&FaceSpeeds::soil_old, &FaceSpeeds::soil},
    kWaterSpeeds{&FaceSpeeds::water_old, &FaceSpeeds::water};

/// One component of a phase's velocity on the window of a cell at the start and the end of the step, m/s:
/// where it lies, or with folds gathered.
template <SpeedMembers members>
struct OpenWindow {
  const FaceSpeeds* home;
  FaceSteps step;
  double old(int x, int y, int z) const { return home[step.to(x, y, z)].*members.old; }
  double now(int x, int y, int z) const { return home[step.to(x, y, z)].*members.now; }
};
template <SpeedMembers members, int D>
struct FoldedWindow {
  std::array<double, CellWindow<D>::kFaces> old_, now_;
  FoldedWindow(const State<D>& s, const CellWindow<D>& window, int d) {
    window.faces(d, [&](int node, int face, double sign) {
      old_[node] = sign * (s.speeds[d][face].*members.old);
      now_[node] = sign * (s.speeds[d][face].*members.now);
    });
  }
  double old(int x, int y, int z) const { return old_[x + 4 * (y + 3 * z)]; }
  double now(int x, int y, int z) const { return now_[x + 4 * (y + 3 * z)]; }
};

/// On the windows of two cells, in the lanes of the points of each.
template <class Window, int D>
struct PairedWindow {
  const PointBatch<D>& batch;
  Window first, second;
  QUICKSAND_INLINE BatchLanes old(int x, int y, int z) const {
    return batch.by_cell(first.old(x, y, z), second.old(x, y, z));
  }
  QUICKSAND_INLINE BatchLanes now(int x, int y, int z) const {
    return batch.by_cell(first.now(x, y, z), second.now(x, y, z));
  }
};

/// f(d, velocities) for all components, d as a type with the number as `value`.
template <SpeedMembers members, int D, class F>
QUICKSAND_INLINE void for_velocities(const State<D>& s, const PointBatch<D>& batch, const BatchWindows<D>& at,
                                     F&& f) {
  using Open = OpenWindow<members>;
  using Folded = FoldedWindow<members, D>;
  const auto open = [&](int d, int cell) __attribute__((always_inline)) {
    return Open{&s.speeds[d][at.home[cell]], FaceSteps(s.grid, d)};
  };
  if (!at.open())
    for_components<D>([&](auto d) __attribute__((always_inline)) {
      const Folded first(s, at.window[0], d);
      if constexpr (PointBatch<D>::kPairs)
        f(d, PairedWindow<Folded, D>{batch, first, Folded(s, at.window[1], d)});
      else
        f(d, first);
    });
  else if (PointBatch<D>::kPairs && batch.cells == 2)
    for_components<D>([&](auto d) __attribute__((always_inline)) {
      f(d, PairedWindow<Open, D>{batch, open(d, 0), open(d, 1)});
    });
  else
    for_components<D>([&](auto d) __attribute__((always_inline)) { f(d, open(d, 0)); });
}
/// Their sums for a batch's points, one by one.
template <int d, int D, class Kernel, class Velocity>
QUICKSAND_INLINE BatchLanes old_value(const Kernel& kernel, const Velocity& v) {
  return window_value<d, D>(
      kernel, [&](int x, int y, int z) __attribute__((always_inline)) { return v.old(x, y, z); });
}
template <int d, int D, class Kernel, class Velocity>
QUICKSAND_INLINE BatchLanes new_value(const Kernel& kernel, const Velocity& v) {
  return window_value<d, D>(
      kernel, [&](int x, int y, int z) __attribute__((always_inline)) { return v.now(x, y, z); });
}
/// With second(nodes, i) in place of the derivatives.
template <int d, int D, class Kernel, class Velocity, class Second>
QUICKSAND_INLINE WindowSum<D> new_sum(const Kernel& kernel, const Velocity& v, const Second& second) {
  return window_sum<d, D>(
      kernel, [&](int x, int y, int z) __attribute__((always_inline)) { return v.now(x, y, z); }, second);
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
  for (int k = 0; k < batch.count; ++k)
    for (int j = 0; j < D; ++j)
      set.affine[batch.point[k]][d][axis_of(d, j)] = grid.inverse_h * sum.slope[j][k];
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
  for (int k = 0; k < batch.count; ++k) {
    Vec<D> at, by;
    for (int d = 0; d < D; ++d) at[d] = x[d][k], by[d] = way[d][k];
    stopped += move_point<D>(grid, walls, windows.home[batch.cell_of(k)], at, by);
    for (int d = 0; d < D; ++d) x[d][k] = at[d];
  }
  return stopped;
}

}  // namespace quicksand
