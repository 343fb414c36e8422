#pragma once
// What points leave on the windows of their cells, row by row along x: on four faces of a row, or three
// centres, m numbers each. Pairs are one vector of eight. Node by node the same is in grid/stencil.hpp.

#include <algorithm>
#include <cstddef>

#include "engine/grid/cell_kernel.hpp"
#include "engine/grid/shuffles.hpp"

namespace quicksand {

/// Rows of the window of component d. Along x lie four faces of component 0; three of the others, and a
/// fourth place whose weight is zero.
template <int d, int D>
struct WindowRows {
  static constexpr int across = d == 1 ? 4 : 3, deep = D == 2 ? 1 : d == 2 ? 4 : 3, count = across * deep;
  /// For node k in the order of Walls::CellFolds: which one it is of all rows.
  static constexpr int place(int k) {
    std::array<int, 3> at{};
    at[axis_of(d, 0)] = k % 4;
    at[axis_of(d, 1)] = k / 4 % 3;
    if (D == 3) at[axis_of(d, 2)] = k / 12;
    return 4 * (at[1] + across * at[2]) + at[0];
  }
};

/// Pairs of numbers, point by point.
struct alignas(64) PairsByPoint {
  std::array<double, 2 * kBatch> at;
  PairsByPoint() = default;
  QUICKSAND_INLINE PairsByPoint(const BatchLanes& a, const BatchLanes& b) {
    const auto both = interleaved<kBatch>(a, b);
    put_lanes<kBatch>(at[0], both[0]), put_lanes<kBatch>(at[kBatch], both[1]);
  }
  /// Of point k, four times.
  QUICKSAND_INLINE Lanes<8> operator[](int k) const { return four_times(&at[2 * k]); }
};

/// Numbers of up to four nodes along x, point by point: m of each node.
template <int m>
struct NodesByPoint {
  std::array<Kept<4 * m>, kBatch> of;
  QUICKSAND_INLINE Lanes<4 * m> operator[](int k) const { return of[k].lanes(); }
};
/// Pairs of a and b.
template <std::size_t n>
QUICKSAND_INLINE NodesByPoint<2> by_point(const std::array<BatchLanes, n>& a,
                                          const std::array<BatchLanes, n>& b) {
  NodesByPoint<2> nodes;
  std::array<BatchLanes, 8> rows{};
  each<n>([&](auto i) __attribute__((always_inline)) { rows[2 * i] = a[i], rows[2 * i + 1] = b[i]; });
  rows = transposed<8>(rows);
  each<kBatch>([&](auto k) __attribute__((always_inline)) { nodes.of[k] = rows[k]; });
  return nodes;
}
template <std::size_t n>
QUICKSAND_INLINE NodesByPoint<1> by_point(const std::array<BatchLanes, n>& a) {
  NodesByPoint<1> nodes;
  std::array<Lanes<4>, 4> low{}, high{};
  each<n>([&](auto i) __attribute__((always_inline)) {
    low[i] = low_half<kBatch>(a[i]), high[i] = high_half<kBatch>(a[i]);
  });
  low = transposed<4>(low), high = transposed<4>(high);
  each<4>([&](auto k) __attribute__((always_inline)) { nodes.of[k] = low[k], nodes.of[k + 4] = high[k]; });
  return nodes;
}

/// x for the second number of each pair, else 0.
QUICKSAND_INLINE Lanes<8> second_of_pairs(double x) {
  return lanes_of<8>([&](int k) { return k % 2 ? x : 0.0; });
}
/// Number of the node that each pair belongs to.
QUICKSAND_INLINE Lanes<8> node_numbers() {
  return lanes_of<8>([](int k) { return k / 2 - 1.0; });
}

/// f(row, y, z) for the rows of component d.
template <int d, int D, class F>
QUICKSAND_INLINE void for_rows(F&& f) {
  using Rows = WindowRows<d, D>;
  each<Rows::count>([&](auto row) __attribute__((always_inline)) {
    f(row, std::integral_constant<int, row % Rows::across>{},
      std::integral_constant<int, row / Rows::across>{});
  });
}

/// Of a window that no wall reaches: the first node of each row among `faces`.
template <int d, int D, class T>
QUICKSAND_INLINE std::array<T*, WindowRows<d, D>::count> first_of_rows(const Grid<D>& grid,
                                                                       const CellWindow<D>& window,
                                                                       T* faces) {
  const std::ptrdiff_t up = grid.stride[1], deeper = D == 3 ? grid.stride[D - 1] : 0;
  T* const low = faces + (window.home() - 1 - up - deeper);
  std::array<T*, WindowRows<d, D>::count> first;
  for_rows<d, D>([&](auto row, auto y, auto z) __attribute__((always_inline)) {
    first[row] = y > 0   ? first[y > 0 ? row - 1 : 0] + up
                 : z > 0 ? first[z > 0 ? row - WindowRows<d, D>::across : 0] + deeper
                         : low;
  });
  return first;
}

/// Factors of the rows, point by point.
template <int rows>
using RowFactors = std::array<Kept<>, rows>;
/// Nodes along an axis as the faces of component d have them.
template <int d, int axis, class Kernel>
QUICKSAND_INLINE const auto& nodes_along(const Kernel& kernel) {
  if constexpr (axis == d)
    return kernel.face[axis];
  else
    return kernel.center[axis];
}
/// Weights of the rows of component d.
template <int d, int D, class Kernel>
QUICKSAND_INLINE RowFactors<WindowRows<d, D>::count> row_weights(const Kernel& kernel) {
  RowFactors<WindowRows<d, D>::count> weight;
  const auto& second = nodes_along<d, 1>(kernel);
  const auto& third = nodes_along<d, D - 1>(kernel);
  for_rows<d, D>([&](auto r, auto y, auto z) __attribute__((always_inline)) {
    weight[r] = D == 2 ? second.w[y] : second.w[y] * third.w[z];
  });
  return weight;
}

/// m numbers on each node of a window.
template <int rows, int m = 2>
using RowSums = std::array<Lanes<4 * m>, rows>;

/// What such numbers go with: a factor by rows, and along(k) for point k, numbers of four nodes.
template <int rows, class Along>
struct Term {
  const RowFactors<rows>& factor;
  const Along& along;
  QUICKSAND_INLINE Term(const RowFactors<rows>& by_row, const Along& by_point)
      : factor(by_row), along(by_point) {}
};
template <std::size_t rows, class Along>
Term(const std::array<Kept<>, rows>&, const Along&) -> Term<static_cast<int>(rows), Along>;

/// Σ of along(k) × factor[row][k] over the points `from` to `to` and all terms, m numbers on each node. So
/// many rows at once as registers hold.
template <int m, int rows, class... Along>
QUICKSAND_INLINE RowSums<rows, m> sum_points(int from, int to, const Term<rows, Along>&... terms) {
  RowSums<rows, m> sums;
  constexpr int some = kRegister == 8 ? rows : std::min(rows, 12 / m);
  each<(rows + some - 1) / some>([&](auto part) __attribute__((always_inline)) {
    constexpr int first = part * some, count = std::min(some, rows - first);
    std::array<Lanes<4 * m>, count> sum{};
    const auto add = [&](int k, const auto& term) __attribute__((always_inline)) {
      const Lanes<4 * m> along = term.along(k);
      each<count>([&](auto r)
                      __attribute__((always_inline)) { sum[r] += term.factor[first + r][k] * along; });
    };
    for (int k = from; k < to; ++k) (add(k, terms), ...);
    each<count>([&](auto r) __attribute__((always_inline)) { sums[first + r] = sum[r]; });
  });
  return sums;
}

/// Whether the last of a node's numbers is the component of a vector, which changes its sign in a mirror.
template <class Numbers>
inline constexpr bool kLastIsOfVector = true;

/// Adds the sums of a window of component d to the faces. Where a wall folds them into its mirror and vectors
/// change their sign, `mirrored(face, first)` is told the first number.
template <int d, int D, class Numbers, class F>
QUICKSAND_INLINE void add_to_faces(
    const Grid<D>& grid, const CellWindow<D>& window,
    const RowSums<WindowRows<d, D>::count, sizeof(Numbers) / sizeof(double)>& sums, Field<Numbers>& to,
    const F& mirrored) {
  constexpr int m = sizeof(Numbers) / sizeof(double), row = 4 * m;
  using Rows = WindowRows<d, D>;
  if (window.open()) {
    const auto first = first_of_rows<d>(grid, window, to.data());
    each<Rows::count>([&](auto r) __attribute__((always_inline)) {
      add_lanes<row>(reinterpret_cast<double&>(*first[r]), sums[r]);
    });
    return;
  }
  alignas(64) std::array<double, row * Rows::count> of;
  each<Rows::count>([&](auto r) __attribute__((always_inline)) { put_lanes<row>(of[row * r], sums[r]); });
  window.faces(d, [&](int node, int face, double sign) {
    const double* numbers = &of[m * Rows::place(node)];
    double* at = &reinterpret_cast<double&>(to[face]);
    if (m == 2) at[0] += numbers[0];
    at[m - 1] += kLastIsOfVector<Numbers> ? sign * numbers[m - 1] : numbers[m - 1];
    if (sign < 0) mirrored(face, numbers[0]);
  });
}

/// f(cell, numbers) for the centres of a window, whose rows are those of component 0.
template <int m, int D, class F>
QUICKSAND_INLINE void for_centers_of(const CellWindow<D>& window,
                                     const RowSums<WindowRows<0, D>::count, m>& sums, const F& f) {
  constexpr int row = 4 * m;
  alignas(64) std::array<double, row * WindowRows<0, D>::count> of;
  each<WindowRows<0, D>::count>([&](auto r)
                                    __attribute__((always_inline)) { put_lanes<row>(of[row * r], sums[r]); });
  window.centers([&](int node, int cell)
                     __attribute__((always_inline)) { f(cell, &of[row * (node / 3) + m * (node % 3)]); });
}

}  // namespace quicksand
