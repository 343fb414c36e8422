#pragma once
// Weights of one point on the staggered faces and on the cell centres.

#include <type_traits>

#include "engine/grid/point_kernel.hpp"
#include "engine/grid/walls.hpp"

namespace quicksand {

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
  Vec<D> a;
  for (int j = 0; j < D; ++j)
    if constexpr (std::is_same_v<Shape, LinearHat>)
      a[j] = f.gradient[j];
    else
      a[j] = f.w * f.arm[j] * inverse_h * inverse_h / QuadraticSpline::spread;
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

/// Nodes along axis a of the faces of component d.
template <int d, int a, class Kernel>
inline const auto& nodes(const Kernel& k) {
  if constexpr (a == d)
    return k.face(a);
  else
    return k.center(a);
}
template <int d, class Shape>
constexpr int node_count(int a) {
  return a == d ? Shape::faces : Shape::centers;
}

/// Multiplies a weight and its gradient by the factors of node i along axis a.
template <int D, class Weight, class Nodes>
inline void multiply(Weight& weight, const Nodes& n, int a, int i, double h) {
  const double w = n.w[i];
  weight.w *= w;
  for (int b = 0; b < D; ++b) weight.gradient[b] *= b == a ? n.dw[i] : w;
  weight.arm[a] = (static_cast<int>(n.first) + i - n.at) * h;
}

}  // namespace stencil

/// f(d) for all components, each as a type with the number as `value`.
template <int D, class F>
QUICKSAND_INLINE void for_components(F&& f) {
  f(std::integral_constant<int, 0>{}), f(std::integral_constant<int, 1>{});
  if constexpr (D == 3) f(std::integral_constant<int, 2>{});
}

namespace stencil {

template <int d, int D, class Kernel, class F>
inline void faces(const Grid<D>& grid, const Walls<D>& walls, const Kernel& k, F& f) {
  using Shape = typename Kernel::Shape;
  const auto* folds = walls.folds(k.home());
  // Along axis a, the factors of those before it being in `weight`.
  const auto along = [&](const auto& self, auto axis, const FaceWeight<D>& weight, int face, int slot,
                         int scale) -> void {
    constexpr int a = decltype(axis)::value;
    const auto& n = nodes<d, a>(k);
    for (int i = 0; i < node_count<d, Shape>(a); ++i) {
      FaceWeight<D> product = weight;
      multiply<D>(product, n, a, i, grid.h);
      const int position = static_cast<int>(n.first) + i;
      const int to = face + position * grid.stride[a], at = slot + (position + 1) * (a == d ? 1 : scale);
      if constexpr (a + 1 < D) {
        self(self, std::integral_constant<int, a + 1>{}, product, to, at, a == d ? scale : 3 * scale);
      } else if (folds) {
        const Fold& fold = folds->face[d][at];
        call<D>(f, fold.target, product, walls.sign(d, fold));
      } else {
        call<D>(f, to, product, 1.0);
      }
    }
  };
  FaceWeight<D> one;
  one.gradient.fill(grid.inverse_h);
  along(along, std::integral_constant<int, 0>{}, one, k.home(), 0, 4);
}

}  // namespace stencil

/// Calls f(face, weight, sign, gradient) for the faces of component d around a point. `sign` goes with
/// momenta, forces and velocities. f may take a `FaceWeight` in place of weight and gradient: f(face, weight,
/// sign).
template <int D, class Kernel, class F>
inline void for_faces(const Grid<D>& grid, const Walls<D>& walls, const Kernel& k, int d, F&& f) {
  if (d == 0)
    stencil::faces<0>(grid, walls, k, f);
  else if (d == 1)
    stencil::faces<1>(grid, walls, k, f);
  else if constexpr (D == 3)
    stencil::faces<2>(grid, walls, k, f);
}

/// Calls f(cell, weight) for the cell centres around a point.
template <int D, class Kernel, class F>
inline void for_centers(const Grid<D>& grid, const Walls<D>& walls, const Kernel& k, F&& f) {
  constexpr int n = Kernel::Shape::centers;
  const auto* folds = walls.folds(k.home());
  const auto& x = k.center(0);
  for (int row = 0; row < power(n, D - 1); ++row) {
    double outer = 1;
    int cell = k.home() + static_cast<int>(x.first), slot = static_cast<int>(x.first) + 1;
    for (int a = 1, rest = row, scale = 3; a < D; ++a, rest /= n, scale *= 3) {
      const auto& s = k.center(a);
      const int position = static_cast<int>(s.first) + rest % n;
      outer *= s.w[rest % n];
      cell += position * grid.stride[a];
      slot += (position + 1) * scale;
    }
    for (int i = 0; i < n; ++i) f(folds ? folds->center[slot + i] : cell + i, outer * x.w[i]);
  }
}

}  // namespace quicksand
