#pragma once
// Background lattice: cubic cells of edge h, padded so that no kernel reaches outside the arrays.
// One index serves cells and faces: face `c` of component d lies on the low side of cell `c` along d.
//
// About an axis the lattice is a half plane of radius x and height y, and every mass, volume, area and force
// is per radian: that of the plane times the radius.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace quicksand {

template <int D>
using Vec = std::array<double, D>;
template <int D>
using Cell = std::array<int, D>;

/// Axis that points up where gravity does not say: y, in the plane and in space alike.
inline constexpr int kUp = 1;

template <int D>
struct Grid {
  static constexpr int pad = 2;  ///< cells beyond the domain; a quadratic kernel reaches 1.5 h

  Cell<D> cells{};              ///< inside the domain
  Cell<D> size{};               ///< with padding
  std::array<int, D> stride{};  ///< x fastest
  Vec<D> origin{};              ///< m, low corner of the domain
  double h = 1;                 ///< m
  double inverse_h = 1;         ///< 1/m
  bool axial = false;           ///< x is the radius from an axis; D = 2 only

  Grid() = default;
  Grid(const Vec<D>& low, const Cell<D>& count, double edge)
      : cells(count), origin(low), h(edge), inverse_h(1 / edge) {
    int step = 1;
    for (int d = 0; d < D; ++d) {
      size[d] = cells[d] + 2 * pad;
      stride[d] = step;
      step *= size[d];
    }
  }

  int count() const { return stride[D - 1] * size[D - 1]; }
  double cell_volume() const { return D == 2 ? h * h : h * h * h; }  ///< m³ (per metre in the plane)
  double face_area() const { return D == 2 ? h : h * h; }            ///< m²
  /// Factors of the areas and volumes above about an axis, the radius in metres; 1 otherwise.
  double face_radius(int d, int face) const {
    return axial ? origin[0] + (face % size[0] - pad + (d == 0 ? 0.0 : 0.5)) * h : 1;
  }
  double cell_radius(int cell) const { return face_radius(kUp, cell); }
  double radius(const Vec<D>& x) const { return axial ? x[0] : 1; }

  int index(const Cell<D>& c) const {
    int i = 0;
    for (int d = 0; d < D; ++d) i += (c[d] + pad) * stride[d];
    return i;
  }
  Cell<D> cell(int index) const {
    Cell<D> c;
    for (int d = D - 1; d >= 0; --d) {
      c[d] = index / stride[d] - pad;
      index %= stride[d];
    }
    return c;
  }
  bool inside(const Cell<D>& c) const {
    for (int d = 0; d < D; ++d)
      if (c[d] < 0 || c[d] >= cells[d]) return false;
    return true;
  }
  /// Cell that holds x; positions outside the domain give the nearest cell in it.
  Cell<D> cell_of(const Vec<D>& x) const {
    Cell<D> c;
    for (int d = 0; d < D; ++d)
      c[d] = static_cast<int>(std::max(0.0, std::min(cells[d] - 1.0, (x[d] - origin[d]) * inverse_h)));
    return c;
  }
  Vec<D> center(const Cell<D>& c) const {
    Vec<D> x;
    for (int d = 0; d < D; ++d) x[d] = origin[d] + (c[d] + 0.5) * h;
    return x;
  }
};

/// f(std::true_type) about an axis, else f(std::false_type): loops over points and rows decide once.
template <int D, class F>
decltype(auto) with_axial(const Grid<D>& grid, F&& f) {
  if constexpr (D == 2) {
    if (grid.axial) return f(std::true_type{});
  }
  return f(std::false_type{});
}

/// Calls f(index, cell) for every cell of the domain, x fastest.
template <int D, class F>
void for_each_cell(const Grid<D>& grid, F&& f) {
  Cell<D> c{};
  const int rows = [&] {
    int n = 1;
    for (int d = 1; d < D; ++d) n *= grid.cells[d];
    return n;
  }();
  for (int row = 0; row < rows; ++row) {
    int rest = row;
    for (int d = 1; d < D; ++d) {
      c[d] = rest % grid.cells[d];
      rest /= grid.cells[d];
    }
    c[0] = 0;
    int i = grid.index(c);
    for (; c[0] < grid.cells[0]; ++c[0], ++i) f(i, c);
  }
}

}  // namespace quicksand
