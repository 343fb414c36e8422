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

/// Calls f(face, weight, sign, gradient) for the faces of component d around a point. `sign` goes with
/// momenta, forces and velocities. f may take a `FaceWeight` in place of weight and gradient: f(face, weight,
/// sign).
template <int D, class Shape, class F>
inline void for_faces(const Grid<D>& grid, const Walls<D>& walls, const PointKernel<D, Shape>& k, int d,
                      F&& f) {
  constexpr bool with_arm = std::is_invocable_v<F, int, const FaceWeight<D>&, double>;
  constexpr int n = power(Shape::nodes, D);
  std::array<int, D> position;
  const auto* folds = walls.folds(k.home);
  const auto call = [&](int face, const FaceWeight<D>& weight, double sign) {
    if constexpr (with_arm)
      f(face, weight, sign);
    else
      f(face, weight.w, sign, weight.gradient);
  };
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
      if constexpr (with_arm) weight.arm[a] = (position[a] - s.at) * grid.h;
    }
    if (!folds) {
      int face = k.home;
      for (int a = 0; a < D; ++a) face += position[a] * grid.stride[a];
      call(face, weight, 1.0);
    } else {
      int slot = position[d] + 1;
      for (int a = 0, scale = 4; a < D; ++a)
        if (a != d) slot += (position[a] + 1) * scale, scale *= 3;
      const Fold& fold = folds->face[d][slot];
      double sign = fold.tangential;
      if (fold.normal_wall >= 0 && !walls.separated(d, fold.normal_wall)) sign = -sign;
      call(fold.target, weight, sign);
    }
  }
}

/// Calls f(cell, weight) for the cell centres around a point.
template <int D, class Shape, class F>
inline void for_centers(const Grid<D>& grid, const Walls<D>& walls, const PointKernel<D, Shape>& k, F&& f) {
  constexpr int n = power(Shape::nodes, D);
  const auto* folds = walls.folds(k.home);
  for (int i = 0; i < n; ++i) {
    double w = 1;
    int cell = k.home, slot = 0;
    for (int a = 0, rest = i, scale = 1; a < D; ++a, rest /= Shape::nodes, scale *= 3) {
      const int j = rest % Shape::nodes, position = k.center[a].first + j;
      w *= k.center[a].w[j];
      cell += position * grid.stride[a];
      slot += (position + 1) * scale;
    }
    f(folds ? folds->center[slot] : cell, w);
  }
}

}  // namespace quicksand
