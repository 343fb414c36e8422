#pragma once
// The shape functions between points and grid, along one axis. Both sum to one with their mean at the point,
// on the faces and on the cell centres; what differs is their reach and smoothness. A pass over points is
// compiled for each, so that no point asks which one it is.

#include <array>

#include "engine/grid/lanes.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// Weights of the nodes that a point reaches along one axis, and their derivatives with respect to the
/// point's position (per cell). Nodes are numbered in cells from the low side of the point's own cell: faces
/// at whole numbers, centre k at k + ½. T is double, or lanes of several points.
template <int n, class T = double>
struct Nodes {
  std::array<T, n> w, dw;
  T first{};  ///< number of the first node
  T at{};     ///< the point's own position in the nodes' numbers
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
  static constexpr int faces = 3, centers = 3;  ///< nodes along an axis
  static constexpr double spread =
      0.25;  ///< cells², Σ w (x_i − x_p)² of the nodes along an axis, wherever x_p

  template <class T>
  static Nodes<3, T> on_faces(const T& xi) {
    return around(xi, where(xi < 0.5, all_lanes<T>(-1), all_lanes<T>(0)));
  }
  template <class T>
  static Nodes<3, T> on_centers(const T& xi) {
    return around<T>(xi - 0.5, all_lanes<T>(-1));
  }

 private:
  template <class T>
  static Nodes<3, T> around(const T& at, const T& first) {
    const T t = at - (first + 1);  // from the middle node, |t| ≤ ½
    const T a = 0.5 - t, b = 0.5 + t;
    return {{0.5 * a * a, 0.75 - t * t, 0.5 * b * b}, {-a, -2 * t, b}, first, at};
  }
};

/// Linear hat: two nodes. Gradients jump between cells, and the last face that a body reaches may hold next
/// to nothing of it (see step/light_faces.cpp).
struct LinearHat {
  using Mover = HatMover;
  static constexpr int faces = 2, centers = 2;
  /// A face with less than this part of its neighbour's mass does not move on its own. Larger: longer steps,
  /// and gaps between bodies close earlier. A full face's stable step is h/c, that of the lightest
  /// 2√light_part h/c.
  static constexpr double light_part = 0.1;
  template <class T>
  static Nodes<2, T> on_faces(const T& xi) {
    return around(xi, all_lanes<T>(0));
  }
  template <class T>
  static Nodes<2, T> on_centers(const T& xi) {
    return around<T>(xi - 0.5, where(xi < 0.5, all_lanes<T>(-1), all_lanes<T>(0)));
  }

 private:
  template <class T>
  static Nodes<2, T> around(const T& at, const T& first) {
    const T t = at - first;
    return {{1 - t, t}, {all_lanes<T>(-1), all_lanes<T>(1)}, first, at};
  }
};

struct SplineMover {
  static constexpr int faces = 3, centers = 2;
  template <class T>
  static Nodes<3, T> on_faces(const T& xi) {
    return QuadraticSpline::on_faces(xi);
  }
  template <class T>
  static Nodes<2, T> on_centers(const T& xi) {
    return LinearHat::on_centers(xi);
  }
};

struct HatMover {
  static constexpr int faces = 2, centers = 1;
  template <class T>
  static Nodes<2, T> on_faces(const T& xi) {
    return LinearHat::on_faces(xi);
  }
  template <class T>
  static Nodes<1, T> on_centers(const T& xi) {
    return {{all_lanes<T>(1)}, {all_lanes<T>(0)}, all_lanes<T>(0), xi - 0.5};
  }
};

/// f(Shape) with the kernel of that name.
template <class F>
auto with_kernel(Kernel kernel, F&& f) {
  return kernel == Kernel::linear ? f(LinearHat{}) : f(QuadraticSpline{});
}

}  // namespace quicksand
