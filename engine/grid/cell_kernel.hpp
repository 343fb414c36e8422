#pragma once
// Weights of points, some at once, in the windows of the cells they lie in. The faces that a kernel may reach
// from anywhere in a cell are few: a window of four along the component's own axis and three along the
// others, and three centres along every axis. What is on them is fetched once per cell, and walls are folded
// while it is.

#include <array>

#include "engine/grid/point_kernel.hpp"
#include "engine/grid/walls.hpp"

namespace quicksand {

/// Axes as the faces of component d see them: its own, then the others in ascending order.
constexpr int axis_of(int d, int k) { return k == 0 ? d : k - 1 < d ? k - 1 : k; }

/// Weights of up to `size` points along one axis, on the nodes from number −1 on.
template <int n>
struct WindowNodes {
  std::array<BatchLanes, n> w, dw;
  BatchLanes at;  ///< the points' own positions in the nodes' numbers
  /// Cells from the points to node i, as kernels see it.
  BatchLanes arm(int i) const { return (i - 1.0) - at; }
};

/// `nodes`, of which the first is number −1 or 0, among the n from −1 on.
template <int n, int m>
QUICKSAND_INLINE WindowNodes<n> in_window(const Nodes<m, BatchLanes>& nodes) {
  WindowNodes<n> out;
  const auto low = nodes.first < -0.5;
  const BatchLanes none{};
  each<n>([&](auto i) __attribute__((always_inline)) {
    constexpr bool first = (i < m), second = (i > 0) && (i <= m);  // which of the two may reach it
    constexpr int a = first ? i : 0, b = second ? i - 1 : 0;
    out.w[i] = where(low, first ? nodes.w[a] : none, second ? nodes.w[b] : none);
    out.dw[i] = where(low, first ? nodes.dw[a] : none, second ? nodes.dw[b] : none);
  });
  out.at = nodes.at;
  return out;
}

/// Of up to `kBatch` points.
template <int D, class Shape>
struct CellKernel {
  std::array<WindowNodes<4>, D> face;    ///< along each axis, on the faces across it
  std::array<WindowNodes<3>, D> center;  ///< on the centres

  /// x[d]: the places along axis d, in the cells `c`; beyond their edges counts as on them.
  QUICKSAND_INLINE void find(const Grid<D>& grid, const std::array<BatchLanes, D>& c,
                             const std::array<BatchLanes, D>& x) {
    each<D>([&](auto d) __attribute__((always_inline)) {
      const BatchLanes xi = clamped<BatchLanes>((x[d] - grid.origin[d]) * grid.inverse_h - c[d], BatchLanes{},
                                                all_lanes<BatchLanes>(1));
      face[d] = in_window<4>(Shape::template on_faces<BatchLanes>(xi));
      center[d] = in_window<3>(Shape::template on_centers<BatchLanes>(xi));
    });
  }
};

/// From a cell to the faces of component d in its window: node (0, 0, 0) is one step below it along every
/// axis.
struct FaceSteps {
  int own, other, last;
  template <int D>
  FaceSteps(const Grid<D>& grid, int d)
      : own(grid.stride[d]),
        other(grid.stride[axis_of(d, 1)]),
        last(D == 3 ? grid.stride[axis_of(d, D - 1)] : 0) {}
  int to(int x, int y, int z) const { return (x - 1) * own + (y - 1) * other + (z - 1) * last; }
};

/// The windows of a cell.
template <int D>
class CellWindow {
 public:
  static constexpr int kLast = D == 3 ? 3 : 1;  ///< nodes along the last axis
  static constexpr int kFaces = Walls<D>::kFaces, kCenters = Walls<D>::kCells;

  CellWindow(const Grid<D>& grid, const Walls<D>& walls, int home)
      : grid_(grid), walls_(walls), home_(home), folds_(walls.folds(home)) {}
  bool open() const { return folds_ == nullptr; }  ///< no wall is in reach

  /// f(k, face, sign) for node k of the window of component d, in the order of Walls::CellFolds. `sign` goes
  /// with momenta, forces and velocities.
  template <class F>
  QUICKSAND_INLINE void faces(int d, F&& f) const {
    if (folds_) {
      for (int k = 0; k < kFaces; ++k) {
        const Fold& fold = folds_->face[d][k];
        f(k, fold.target, walls_.sign(d, fold));
      }
      return;
    }
    const FaceSteps step(grid_, d);
    for (int z = 0; z < kLast; ++z)
      for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 4; ++x) f(x + 4 * (y + 3 * z), home_ + step.to(x, y, z), 1.0);
  }
  /// f(k, cell) for node k of the window of centres, x fastest.
  template <class F>
  QUICKSAND_INLINE void centers(F&& f) const {
    for (int z = 0; z < kLast; ++z)
      for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x) {
          const int k = x + 3 * (y + 3 * z);
          f(k, folds_ ? folds_->center[k]
                      : home_ + (x - 1) + (y - 1) * grid_.stride[1] +
                            (D == 3 ? (z - 1) * grid_.stride[D - 1] : 0));
        }
  }
  int home() const { return home_; }

 private:
  const Grid<D>& grid_;
  const Walls<D>& walls_;
  int home_;
  const typename Walls<D>::CellFolds* folds_;
};

/// Σ over the window of component d of values times weights: `value` with all weights, slope[k] with the
/// derivative along axis_of(d, k) (per cell).
template <int D>
struct WindowSum {
  BatchLanes value{};
  std::array<BatchLanes, D> slope{};
};

/// at(x, y, z): value of a node, x along the component's own axis, for all points or for each. second(nodes,
/// i) stands for the derivative of node i's weight.
template <int d, int D, class Kernel, class At, class Second>
QUICKSAND_INLINE WindowSum<D> window_sum(const Kernel& kernel, const At& at, const Second& second) {
  const auto& own = kernel.face[d];
  const auto& other = kernel.center[axis_of(d, 1)];
  const auto& last = kernel.center[axis_of(d, D - 1)];
  WindowSum<D> sum;
  each<CellWindow<D>::kLast>([&](auto z) __attribute__((always_inline)) {
    WindowSum<D> plane;
    each<3>([&](auto y) __attribute__((always_inline)) {
      BatchLanes value{}, slope{};
      each<4>([&](auto x) __attribute__((always_inline)) {
        const auto v = at(x, y, z);
        value += own.w[x] * v;
        slope += second(own, x) * v;
      });
      plane.value += other.w[y] * value;
      plane.slope[0] += other.w[y] * slope;
      plane.slope[1] += second(other, y) * value;
    });
    if constexpr (D == 2) {
      sum = plane;
    } else {
      sum.value += last.w[z] * plane.value;
      each<2>([&](auto k) __attribute__((always_inline)) { sum.slope[k] += last.w[z] * plane.slope[k]; });
      sum.slope[2] += second(last, z) * plane.value;
    }
  });
  return sum;
}

/// Σ values × weights alone.
template <int d, int D, class Kernel, class At>
QUICKSAND_INLINE BatchLanes window_value(const Kernel& kernel, const At& at) {
  const auto& last = kernel.center[axis_of(d, D - 1)];
  BatchLanes sum{};
  each<CellWindow<D>::kLast>([&](auto z) __attribute__((always_inline)) {
    BatchLanes plane{};
    each<3>([&](auto y) __attribute__((always_inline)) {
      BatchLanes row{};
      each<4>([&](auto x) __attribute__((always_inline)) { row += kernel.face[d].w[x] * at(x, y, z); });
      plane += kernel.center[axis_of(d, 1)].w[y] * row;
    });
    if constexpr (D == 2)
      sum = plane;
    else
      sum += last.w[z] * plane;
  });
  return sum;
}

}  // namespace quicksand
