#pragma once
// The shape functions between points and grid, along one axis. Both sum to one with their mean at the point,
// on the faces and on the cell centres; what differs is their reach and smoothness. A pass over points is
// compiled for each, so that no point asks which one it is.

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// Weights of the nodes that a point reaches along one axis, and their derivatives with respect to the
/// point's position (per cell). Nodes are numbered in cells from the low side of the point's own cell: faces
/// at whole numbers, centre k at k + ½.
template <int n>
struct Nodes {
  std::array<double, n> w, dw;
  int first = 0;  ///< number of the first node
  double at = 0;  ///< the point's own position in the nodes' numbers
};

/// What carries water: the component's own axis as the kernel has it, hats across. The derivative of a
/// quadratic spline is a difference of hats, so that what is interpolated has everywhere the divergence that
/// the cells around have: points carried by it keep their volume.
struct SplineMover;
/// The same for hats, whose derivative is a difference of boxes: constant across, within a cell.
struct HatMover;

/// Quadratic B-spline: three nodes, gradients that are continuous when a point goes into the next cell.
struct QuadraticSpline {
  using Mover = SplineMover;
  static constexpr int nodes = 3;
  static constexpr double spread =
      0.25;  ///< cells², Σ w (x_i − x_p)² of the nodes along an axis, wherever x_p

  static Nodes<nodes> on_faces(double xi) { return around(xi, xi < 0.5 ? -1 : 0); }
  static Nodes<nodes> on_centers(double xi) { return around(xi - 0.5, -1); }

 private:
  static Nodes<nodes> around(double at, int first) {
    const double t = at - (first + 1);  // from the middle node, |t| ≤ ½
    return {{0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)},
            {t - 0.5, -2 * t, t + 0.5},
            first,
            at};
  }
};

/// Linear hat: two nodes. Gradients jump between cells, and the last face that a body reaches may hold next
/// to nothing of it (see step/light_faces.cpp).
struct LinearHat {
  using Mover = HatMover;
  static constexpr int nodes = 2;
  /// A face with less than this part of its neighbour's mass does not move on its own. Larger: longer steps,
  /// and gaps between bodies close earlier. A full face's stable step is h/c, that of the lightest
  /// 2√light_part h/c.
  static constexpr double light_part = 0.1;
  static Nodes<nodes> on_faces(double xi) { return around(xi, 0); }
  static Nodes<nodes> on_centers(double xi) { return around(xi - 0.5, xi < 0.5 ? -1 : 0); }

 private:
  static Nodes<nodes> around(double at, int first) {
    const double t = at - first;
    return {{1 - t, t}, {-1, 1}, first, at};
  }
};

struct SplineMover {
  static constexpr int nodes = 3;
  static Nodes<nodes> on_faces(double xi) { return QuadraticSpline::on_faces(xi); }
  static Nodes<nodes> on_centers(double xi) {
    const double t = xi - 0.5;
    return {{std::max(0.0, -t), 1 - std::abs(t), std::max(0.0, t)},
            {t < 0 ? -1.0 : 0.0, t < 0 ? 1.0 : -1.0, t < 0 ? 0.0 : 1.0},
            -1,
            t};
  }
};

struct HatMover {
  static constexpr int nodes = 2;
  static Nodes<nodes> on_faces(double xi) { return LinearHat::on_faces(xi); }
  static Nodes<nodes> on_centers(double xi) { return {{1, 0}, {0, 0}, 0, xi - 0.5}; }
};

/// f(Shape) with the kernel of that name.
template <class F>
auto with_kernel(Kernel kernel, F&& f) {
  return kernel == Kernel::linear ? f(LinearHat{}) : f(QuadraticSpline{});
}

}  // namespace quicksand
