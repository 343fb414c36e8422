#pragma once
// What points leave on the windows of their cells, row by row along x: on four faces of a row, or three
// centres, a pair of numbers each, which is one vector of eight. Node by node the same is in
// grid/stencil.hpp.

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
  /// For node k in the order of Walls::CellFolds: where its pair lies among those of all rows.
  static constexpr int place(int k) {
    std::array<int, 3> at{};
    at[axis_of(d, 0)] = k % 4;
    at[axis_of(d, 1)] = k / 4 % 3;
    if (D == 3) at[axis_of(d, 2)] = k / 12;
    return 8 * (at[1] + across * at[2]) + 2 * at[0];
  }
};

/// Pairs of numbers, point by point.
struct alignas(64) PairsByPoint {
  std::array<double, 2 * kBatch> at;
  QUICKSAND_INLINE PairsByPoint(const BatchLanes& a, const BatchLanes& b) {
    const auto both = interleaved<kBatch>(a, b);
    put_lanes<kBatch>(at[0], both[0]), put_lanes<kBatch>(at[kBatch], both[1]);
  }
  /// Of point k, four times.
  QUICKSAND_INLINE Lanes<8> operator[](int k) const { return four_times(&at[2 * k]); }
};

/// Numbers of the nodes along x, each twice, point by point.
struct NodesByPoint {
  std::array<Kept<8>, kBatch> of;
  QUICKSAND_INLINE explicit NodesByPoint(const std::array<BatchLanes, 4>& w) {
    const auto rows = transposed<8>({w[0], w[0], w[1], w[1], w[2], w[2], w[3], w[3]});
    each<kBatch>([&](auto k) __attribute__((always_inline)) { of[k] = rows[k]; });
  }
  QUICKSAND_INLINE explicit NodesByPoint(const std::array<BatchLanes, 3>& w)
      : NodesByPoint({w[0], w[1], w[2], BatchLanes{}}) {}
  QUICKSAND_INLINE Lanes<8> operator[](int k) const { return of[k].lanes(); }
};

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

/// Pairs on the nodes of a window.
template <int rows>
using RowSums = std::array<Lanes<8>, rows>;

/// What a kind of pair goes with: a factor by rows, and along(k) for point k.
template <int rows, class Along>
struct Term {
  const RowFactors<rows>& factor;
  const Along& along;
  QUICKSAND_INLINE Term(const RowFactors<rows>& by_row, const Along& by_point)
      : factor(by_row), along(by_point) {}
};
template <std::size_t rows, class Along>
Term(const std::array<Kept<>, rows>&, const Along&) -> Term<static_cast<int>(rows), Along>;

/// Σ of along(k) × factor[row][k] over the points `from` to `to` and all terms. So many rows at once as
/// registers hold.
template <int rows, class... Along>
QUICKSAND_INLINE RowSums<rows> sum_points(int from, int to, const Term<rows, Along>&... terms) {
  RowSums<rows> sums;
  constexpr int some = kRegister == 8 || rows < 6 ? rows : 6;
  each<(rows + some - 1) / some>([&](auto part) __attribute__((always_inline)) {
    constexpr int first = part * some, count = std::min(some, rows - first);
    std::array<Lanes<8>, count> sum{};
    const auto add = [&](int k, const auto& term) __attribute__((always_inline)) {
      const Lanes<8> along = term.along(k);
      each<count>([&](auto r)
                      __attribute__((always_inline)) { sum[r] += term.factor[first + r][k] * along; });
    };
    for (int k = from; k < to; ++k) (add(k, terms), ...);
    each<count>([&](auto r) __attribute__((always_inline)) { sums[first + r] = sum[r]; });
  });
  return sums;
}

/// Whether the second of a pair is the component of a vector, which changes its sign in a mirror.
template <class Pair>
inline constexpr bool kLastIsOfVector = true;

/// Adds the sums of a window of component d to the faces. Where a wall folds them into its mirror and vectors
/// change their sign, `mirrored(face, mass)` is told the first number.
template <int d, int D, class Pair, class F>
QUICKSAND_INLINE void add_to_faces(const Grid<D>& grid, const CellWindow<D>& window,
                                   const RowSums<WindowRows<d, D>::count>& sums, Field<Pair>& to,
                                   const F& mirrored) {
  static_assert(sizeof(Pair) == 2 * sizeof(double));
  using Rows = WindowRows<d, D>;
  if (window.open()) {
    const auto first = first_of_rows<d>(grid, window, to.data());
    each<Rows::count>([&](auto row) __attribute__((always_inline)) {
      add_lanes<8>(reinterpret_cast<double&>(*first[row]), sums[row]);
    });
    return;
  }
  alignas(64) std::array<double, 8 * Rows::count> of;
  each<Rows::count>([&](auto r) __attribute__((always_inline)) { put_lanes<8>(of[8 * r], sums[r]); });
  window.faces(d, [&](int node, int face, double sign) {
    const double* pair = &of[Rows::place(node)];
    double* at = &reinterpret_cast<double&>(to[face]);
    at[0] += pair[0], at[1] += kLastIsOfVector<Pair> ? sign * pair[1] : pair[1];
    if (sign < 0) mirrored(face, pair[0]);
  });
}

/// f(cell, pair) for the centres of a window, whose rows are those of component 0.
template <int D, class F>
QUICKSAND_INLINE void for_centers_of(const CellWindow<D>& window,
                                     const RowSums<WindowRows<0, D>::count>& sums, const F& f) {
  alignas(64) std::array<double, 8 * WindowRows<0, D>::count> of;
  each<WindowRows<0, D>::count>([&](auto r)
                                    __attribute__((always_inline)) { put_lanes<8>(of[8 * r], sums[r]); });
  window.centers([&](int node, int cell)
                     __attribute__((always_inline)) { f(cell, &of[8 * (node / 3) + 2 * (node % 3)]); });
}

}  // namespace quicksand
