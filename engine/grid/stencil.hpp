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

/// A row of faces along x, or of cells, without the factors along x: those of a node multiply `w` and all of
/// `gradient` by its own weight, but `gradient[0]` by its derivative.
template <int D, int n>
struct KernelRow {
  int first = 0;  ///< face of node 0; the others follow
  double w = 1;
  Vec<D> gradient{}, arm{};
  std::array<double, n> x, dx;  ///< weights of the nodes along x, and their derivatives, per cell
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
inline auto nodes(const Kernel& k) {
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
  const double w = n.w(i);
  weight.w *= w;
  for (int b = 0; b < D; ++b) weight.gradient[b] *= b == a ? n.dw(i) : w;
  weight.arm[a] = (n.first() + i - n.at()) * h;
}

}  // namespace stencil

/// f(KernelRow) for the rows of faces of component d (a number as a type)
/// around a point that no wall is near.
template <int D, class Kernel, class Component, class F>
inline void for_rows(const Grid<D>& grid, const Kernel& k, Component, F&& f) {
  constexpr int d = Component::value;
  using Shape = typename Kernel::Shape;
  constexpr int nx = stencil::node_count<d, Shape>(0);
  const auto x = stencil::nodes<d, 0>(k);
  const auto y = stencil::nodes<d, 1>(k);
  KernelRow<D, nx> start;
  start.first = k.home() + x.first();
  start.gradient.fill(grid.inverse_h);
  for (int i = 0; i < nx; ++i) start.x[i] = x.w(i), start.dx[i] = x.dw(i);
  const auto plane = [&](const KernelRow<D, nx>& of) {
    for (int j = 0; j < stencil::node_count<d, Shape>(1); ++j) {
      KernelRow<D, nx> row = of;
      row.first += (y.first() + j) * grid.stride[1];
      stencil::multiply<D>(row, y, 1, j, grid.h);
      f(row);
    }
  };
  if constexpr (D == 2) {
    plane(start);
  } else {
    const auto z = stencil::nodes<d, 2>(k);
    for (int j = 0; j < stencil::node_count<d, Shape>(2); ++j) {
      KernelRow<D, nx> of = start;
      of.first += (z.first() + j) * grid.stride[2];
      stencil::multiply<D>(of, z, 2, j, grid.h);
      plane(of);
    }
  }
}

/// f(d) for all components, each as a type with the number as `value`.
template <int D, class F>
QUICKSAND_INLINE void for_components(F&& f) {
  f(std::integral_constant<int, 0>{}), f(std::integral_constant<int, 1>{});
  if constexpr (D == 3) f(std::integral_constant<int, 2>{});
}
/// The vector of f(d).
template <int D, class F>
QUICKSAND_INLINE Vec<D> from_components(F&& f) {
  if constexpr (D == 2)
    return {f(std::integral_constant<int, 0>{}), f(std::integral_constant<int, 1>{})};
  else
    return {f(std::integral_constant<int, 0>{}), f(std::integral_constant<int, 1>{}),
            f(std::integral_constant<int, 2>{})};
}

namespace stencil {

/// Away from walls.
template <int d, int D, class Kernel, class F>
inline void open_faces(const Grid<D>& grid, const Kernel& k, F& f) {
  const auto x = nodes<d, 0>(k);
  for_rows(grid, k, std::integral_constant<int, d>{}, [&](const auto& row) {
    for (std::size_t i = 0; i < row.x.size(); ++i) {
      FaceWeight<D> weight{row.w, row.gradient, row.arm};
      multiply<D>(weight, x, 0, static_cast<int>(i), grid.h);
      call<D>(f, row.first + static_cast<int>(i), weight, 1.0);
    }
  });
}

/// Beside walls.
template <int d, int D, class Kernel, class F>
inline void folded_faces(const Grid<D>& grid, const Walls<D>& walls, const Kernel& k,
                         const typename Walls<D>::CellFolds& folds, F& f) {
  using Shape = typename Kernel::Shape;
  // Along axis a, the factors of those before it being in `weight`.
  const auto along = [&](const auto& self, auto axis, const FaceWeight<D>& weight, int slot,
                         int scale) -> void {
    constexpr int a = decltype(axis)::value;
    const auto n = nodes<d, a>(k);
    for (int i = 0; i < node_count<d, Shape>(a); ++i) {
      FaceWeight<D> product = weight;
      multiply<D>(product, n, a, i, grid.h);
      const int position = n.first() + i + 1, at = slot + position * (a == d ? 1 : scale);
      if constexpr (a + 1 < D) {
        self(self, std::integral_constant<int, a + 1>{}, product, at, a == d ? scale : 3 * scale);
      } else {
        const Fold& fold = folds.face[d][at];
        double sign = fold.tangential;
        if (fold.normal_wall >= 0 && !walls.separated(d, fold.normal_wall)) sign = -sign;
        call<D>(f, fold.target, product, sign);
      }
    }
  };
  FaceWeight<D> one;
  one.gradient.fill(grid.inverse_h);
  along(along, std::integral_constant<int, 0>{}, one, 0, 4);
}

template <int d, int D, class Kernel, class F>
inline void faces(const Grid<D>& grid, const Walls<D>& walls, const Kernel& k, F& f) {
  if (const auto* folds = walls.folds(k.home()))
    folded_faces<d>(grid, walls, k, *folds, f);
  else
    open_faces<d>(grid, k, f);
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
  const auto x = k.center(0);
  for (int row = 0; row < power(n, D - 1); ++row) {
    double outer = 1;
    int cell = k.home() + x.first(), slot = x.first() + 1;
    for (int a = 1, rest = row, scale = 3; a < D; ++a, rest /= n, scale *= 3) {
      const auto s = k.center(a);
      const int position = s.first() + rest % n;
      outer *= s.w(rest % n);
      cell += position * grid.stride[a];
      slot += (position + 1) * scale;
    }
    for (int i = 0; i < n; ++i) f(folds ? folds->center[slot + i] : cell + i, outer * x.w(i));
  }
}

}  // namespace quicksand
