#pragma once
// One-dimensional factors of all weights of a point, alone or with others at once.

#include <algorithm>

#include "engine/grid/grid.hpp"
#include "engine/grid/kernel.hpp"

namespace quicksand {

/// Factors along one axis of one point of those that `nodes` holds.
template <int n, class T>
struct NodesOf {
  const Nodes<n, T>& nodes;
  int k;
  double w(int i) const { return lane(nodes.w[i]); }
  double dw(int i) const { return lane(nodes.dw[i]); }
  int first() const { return static_cast<int>(lane(nodes.first)); }
  double at() const { return lane(nodes.at); }

 private:
  double lane(const T& v) const {
    if constexpr (std::is_same_v<T, double>)
      return v;
    else
      return v[k];
  }
};

/// Of up to `size` points, worked out together, lane by lane.
template <int D, class S>
class KernelBatch {
 public:
  static constexpr int size = 8;

  /// x[d]: the places along axis d, of which those that are not asked for may be anything. Places outside the
  /// domain count as on its edge.
  void find(const Grid<D>& grid, const std::array<Lanes<size>, D>& x) {
    home_ = Ints{};
    for (int d = 0; d < D; ++d) {
      const L end = all_lanes<L>(grid.cells[d]);
      const L place = clamped<L>((x[d] - grid.origin[d]) * grid.inverse_h, L{}, end);
      const Ints down = __builtin_convertvector(place, Ints), last = Ints{} + (grid.cells[d] - 1);
      const Ints cell = down < last ? down : last;
      home_ += (cell + Grid<D>::pad) * grid.stride[d];
      const L xi = place - __builtin_convertvector(cell, L);
      center_[d] = S::template on_centers<L>(xi);
      face_[d] = S::template on_faces<L>(xi);
    }
  }

  /// One of the points, as the functions of stencil.hpp take it.
  class Point {
   public:
    using Shape = S;
    Point(const KernelBatch& batch, int k) : batch_(batch), k_(k) {}
    int home() const { return batch_.home_[k_]; }  ///< index of the point's cell
    auto face(int a) const { return NodesOf<S::faces, L>{batch_.face_[a], k_}; }
    auto center(int a) const { return NodesOf<S::centers, L>{batch_.center_[a], k_}; }

   private:
    const KernelBatch& batch_;
    int k_;
  };
  Point operator[](int k) const { return {*this, k}; }

 private:
  using L = Lanes<size>;
  using Ints = IntLanes<size>;
  Ints home_;
  std::array<Nodes<S::centers, L>, D> center_;
  std::array<Nodes<S::faces, L>, D> face_;
};

/// Of one point.
template <int D, class S = QuadraticSpline>
class PointKernel {
 public:
  using Shape = S;
  PointKernel(const Grid<D>& grid, const Vec<D>& x) {
    const Cell<D> c = grid.cell_of(x);
    home_ = grid.index(c);
    for (int d = 0; d < D; ++d) {
      const double xi = clamped((x[d] - grid.origin[d]) * grid.inverse_h - c[d], 0.0, 1.0);
      center_[d] = S::on_centers(xi);
      face_[d] = S::on_faces(xi);
    }
  }
  int home() const { return home_; }  ///< index of the point's cell
  auto face(int a) const { return NodesOf<S::faces, double>{face_[a], 0}; }
  auto center(int a) const { return NodesOf<S::centers, double>{center_[a], 0}; }

 private:
  int home_ = 0;
  std::array<Nodes<S::centers, double>, D> center_;
  std::array<Nodes<S::faces, double>, D> face_;
};

}  // namespace quicksand
