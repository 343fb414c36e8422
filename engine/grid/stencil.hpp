#pragma once
// Quadratic B-spline weights of one point on the staggered faces and on the cell centres.

#include "engine/grid/walls.hpp"

namespace quicksand {

/// Quadratic B-spline at distances t−1, t, t+1 (in cells) from three nodes, |t| ≤ ½, and its derivative
/// with respect to the point's position (per cell).
struct Spline {
  std::array<double, 3> w, dw;
  explicit Spline(double t = 0) {
    w = {0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)};
    dw = {t - 0.5, -2 * t, t + 0.5};
  }
  /// Hat function on the same three nodes.
  static Spline hat(double t) {
    Spline s;
    s.w = {std::max(0.0, -t), 1 - std::abs(t), std::max(0.0, t)};
    s.dw = {t < 0 ? -1.0 : 0.0, t < 0 ? 1.0 : -1.0, t < 0 ? 0.0 : 1.0};
    return s;
  }
};

/// One-dimensional factors of all weights of a point; computed once per pass.
template <int D>
struct PointKernel {
  int home = 0;                  ///< index of the point's cell
  std::array<Spline, D> center;  ///< nodes: centres of cells −1, 0, 1
  std::array<Spline, D> face;    ///< nodes: faces first−…
  std::array<int, D> first{};    ///< first face position: −1 or 0 (relative to the low side of the cell)

  PointKernel(const Grid<D>& grid, const Vec<D>& x) {
    const Cell<D> c = grid.cell_of(x);
    home = grid.index(c);
    for (int d = 0; d < D; ++d) {
      const double xi = std::clamp((x[d] - grid.origin[d]) * grid.inverse_h - c[d], 0.0, 1.0);
      center[d] = Spline(xi - 0.5);
      first[d] = xi < 0.5 ? -1 : 0;
      face[d] = Spline(xi < 0.5 ? xi : xi - 1);
    }
  }
};

/// The kernel with hats across each component's own axis. The derivative of a quadratic spline is a
/// difference of hats, so that what it interpolates has everywhere the divergence that the cells around have:
/// points carried by it keep their volume.
template <int D>
PointKernel<D> volume_keeping(const PointKernel<D>& kernel, const Grid<D>& grid, const Vec<D>& x) {
  PointKernel<D> k = kernel;
  const Cell<D> c = grid.cell_of(x);
  for (int d = 0; d < D; ++d)
    k.center[d] = Spline::hat(std::clamp((x[d] - grid.origin[d]) * grid.inverse_h - c[d], 0.0, 1.0) - 0.5);
  return k;
}

/// Calls f(face, weight, sign, gradient) for the 3^D faces of component d around a point. `gradient` is of
/// the weight with respect to the point's position (1/m); `sign` goes with momenta, forces and velocities.
template <int D, class F>
inline void for_faces(const Grid<D>& grid, const Walls<D>& walls, const PointKernel<D>& k, int d, F&& f) {
  constexpr int n = power(3, D);
  std::array<int, D> position;
  const auto* folds = walls.folds(k.home);
  for (int i = 0; i < n; ++i) {
    int rest = i;
    double w = 1;
    Vec<D> g;
    g.fill(grid.inverse_h);
    for (int a = 0; a < D; ++a) {
      const int j = rest % 3;
      rest /= 3;
      const Spline& s = a == d ? k.face[a] : k.center[a];
      position[a] = (a == d ? k.first[a] : -1) + j;
      w *= s.w[j];
      for (int b = 0; b < D; ++b) g[b] *= b == a ? s.dw[j] : s.w[j];
    }
    if (!folds) {
      int face = k.home;
      for (int a = 0; a < D; ++a) face += position[a] * grid.stride[a];
      f(face, w, 1.0, g);
    } else {
      int slot = position[d] + 1;
      for (int a = 0, scale = 4; a < D; ++a)
        if (a != d) slot += (position[a] + 1) * scale, scale *= 3;
      const Fold& fold = folds->face[d][slot];
      double sign = fold.tangential;
      if (fold.normal_wall >= 0 && !walls.separated(d, fold.normal_wall)) sign = -sign;
      f(fold.target, w, sign, g);
    }
  }
}

/// Calls f(cell, weight) for the 3^D cell centres around a point.
template <int D, class F>
inline void for_centers(const Grid<D>& grid, const Walls<D>& walls, const PointKernel<D>& k, F&& f) {
  constexpr int n = power(3, D);
  const auto* folds = walls.folds(k.home);
  for (int i = 0; i < n; ++i) {
    double w = 1;
    int cell = k.home;
    for (int a = 0, rest = i; a < D; ++a, rest /= 3) {
      w *= k.center[a].w[rest % 3];
      cell += (rest % 3 - 1) * grid.stride[a];
    }
    f(folds ? folds->center[i] : cell, w);
  }
}

}  // namespace quicksand
