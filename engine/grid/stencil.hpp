#pragma once
// Weights of one point on the staggered faces and on the cell centres.

#include <type_traits>

#include "engine/grid/kernel.hpp"
#include "engine/grid/walls.hpp"

namespace quicksand {

/// One-dimensional factors of all weights of a point; computed once per pass.
template <int D, class Shape = QuadraticSpline>
struct PointKernel {
  using Factor = Nodes<Shape::nodes>;
  int home = 0;                  ///< index of the point's cell
  std::array<Factor, D> center;  ///< nodes: centres of cells
  std::array<Factor, D> face;    ///< nodes: faces

  PointKernel(const Grid<D>& grid, const Vec<D>& x) {
    const Cell<D> c = grid.cell_of(x);
    home = grid.index(c);
    for (int d = 0; d < D; ++d) {
      const double xi = std::clamp((x[d] - grid.origin[d]) * grid.inverse_h - c[d], 0.0, 1.0);
      center[d] = Shape::on_centers(xi);
      face[d] = Shape::on_faces(xi);
    }
  }
  /// The factor along axis a of the weights on faces of component d.
  const Factor& factor(int d, int a) const { return a == d ? face[a] : center[a]; }
};

/// Weight of one face: its product, its gradient with respect to the point's position (1/m), and the arm from
/// the point to the face as the kernel sees it, behind a wall too (m).
template <int D>
struct FaceWeight {
  double w = 1;
  Vec<D> gradient, arm;
};

/// What a face's velocity adds to the gradient that a point carries in the affine transfer, 1/m:
/// w (x_f − x_p) over the kernel's spread, which for hats is the gradient of w.
template <class Shape, int D>
Vec<D> affine_weight(const FaceWeight<D>& f, double inverse_h) {
  if constexpr (std::is_same_v<Shape, LinearHat>) return f.gradient;
  Vec<D> a;
  for (int j = 0; j < D; ++j) a[j] = f.w * f.arm[j] * inverse_h * inverse_h / QuadraticSpline::spread;
  return a;
}

namespace stencil {

/// f(FaceWeight) or f(weight, gradient), whichever it takes.
template <int D, class F>
inline constexpr bool takes_arm = std::is_invocable_v<F, int, const FaceWeight<D>&, double>;
template <int D, class F>
inline void call(F& f, int face, const FaceWeight<D>& weight, double sign) {
  if constexpr (takes_arm<D, F>)
    f(face, weight, sign);
  else
    f(face, weight.w, sign, weight.gradient);
}

/// Away from walls: row by row along x, whose faces lie one after the other in memory.
template <int D, class Shape, class F>
inline void open_faces(const Grid<D>& grid, const PointKernel<D, Shape>& k, int d, F& f) {
  constexpr int n = Shape::nodes;
  const auto& along = k.factor(d, 0);
  for (int row = 0; row < power(n, D - 1); ++row) {
    FaceWeight<D> weight;
    double outer = 1;
    Vec<D> outer_gradient;
    outer_gradient.fill(grid.inverse_h);
    int face = k.home + along.first * grid.stride[0];
    for (int a = 1, rest = row; a < D; ++a, rest /= n) {
      const auto& s = k.factor(d, a);
      const int j = rest % n;
      face += (s.first + j) * grid.stride[a];
      outer *= s.w[j];
      for (int b = 0; b < D; ++b) outer_gradient[b] *= b == a ? s.dw[j] : s.w[j];
      if constexpr (takes_arm<D, F>) weight.arm[a] = (s.first + j - s.at) * grid.h;
    }
#pragma GCC unroll 3
    for (int i = 0; i < n; ++i) {
      weight.w = outer * along.w[i];
      weight.gradient[0] = outer_gradient[0] * along.dw[i];
      for (int b = 1; b < D; ++b) weight.gradient[b] = outer_gradient[b] * along.w[i];
      if constexpr (takes_arm<D, F>) weight.arm[0] = (along.first + i - along.at) * grid.h;
      call<D>(f, face + i, weight, 1.0);
    }
  }
}

/// Beside walls.
template <int D, class Shape, class F>
inline void folded_faces(const Grid<D>& grid, const Walls<D>& walls, const PointKernel<D, Shape>& k, int d,
                         const typename Walls<D>::CellFolds& folds, F& f) {
  constexpr int n = power(Shape::nodes, D);
  std::array<int, D> position;
  for (int i = 0; i < n; ++i) {
    int rest = i;
    FaceWeight<D> weight;
    weight.gradient.fill(grid.inverse_h);
    for (int a = 0; a < D; ++a) {
      const int j = rest % Shape::nodes;
      rest /= Shape::nodes;
      const auto& s = k.factor(d, a);
      position[a] = s.first + j;
      weight.w *= s.w[j];
      for (int b = 0; b < D; ++b) weight.gradient[b] *= b == a ? s.dw[j] : s.w[j];
      if constexpr (takes_arm<D, F>) weight.arm[a] = (position[a] - s.at) * grid.h;
    }
    int slot = position[d] + 1;
    for (int a = 0, scale = 4; a < D; ++a)
      if (a != d) slot += (position[a] + 1) * scale, scale *= 3;
    const Fold& fold = folds.face[d][slot];
    double sign = fold.tangential;
    if (fold.normal_wall >= 0 && !walls.separated(d, fold.normal_wall)) sign = -sign;
    call<D>(f, fold.target, weight, sign);
  }
}

}  // namespace stencil

/// Calls f(face, weight, sign, gradient) for the faces of component d around a point. `sign` goes with
/// momenta, forces and velocities. f may take a `FaceWeight` in place of weight and gradient: f(face, weight,
/// sign).
template <int D, class Shape, class F>
inline void for_faces(const Grid<D>& grid, const Walls<D>& walls, const PointKernel<D, Shape>& k, int d,
                      F&& f) {
  if (const auto* folds = walls.folds(k.home))
    stencil::folded_faces(grid, walls, k, d, *folds, f);
  else
    stencil::open_faces(grid, k, d, f);
}

/// Calls f(cell, weight) for the cell centres around a point.
template <int D, class Shape, class F>
inline void for_centers(const Grid<D>& grid, const Walls<D>& walls, const PointKernel<D, Shape>& k, F&& f) {
  constexpr int n = Shape::nodes;
  const auto* folds = walls.folds(k.home);
  for (int row = 0; row < power(n, D - 1); ++row) {
    double outer = 1;
    int cell = k.home, slot = 0;
    for (int a = 1, rest = row, scale = 3; a < D; ++a, rest /= n, scale *= 3) {
      const int position = k.center[a].first + rest % n;
      outer *= k.center[a].w[rest % n];
      cell += position * grid.stride[a];
      slot += (position + 1) * scale;
    }
#pragma GCC unroll 3
    for (int i = 0; i < n; ++i) {
      const int position = k.center[0].first + i;
      f(folds ? folds->center[slot + position + 1] : cell + position, outer * k.center[0].w[i]);
    }
  }
}

}  // namespace quicksand
