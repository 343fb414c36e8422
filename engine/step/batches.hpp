#pragma once
// Loops over the points of a block, cell by cell, some of a cell at a time with their weights.

#include <utility>

#include "engine/grid/cell_kernel.hpp"
#include "engine/points/blocks.hpp"

namespace quicksand {

namespace batch {

/// v[i][k] = first[n k + i], by shuffles of registers.
template <int n>
QUICKSAND_INLINE std::array<BatchLanes, n> columns(const double* first) {
  std::array<BatchLanes, n> column;
  const auto merge = [&]<int i, int m, int... k>(
      std::integral_constant<int, i>, std::integral_constant<int, m>, std::integer_sequence<int, k...>)
      __attribute__((always_inline)) {
    const BatchLanes part = lanes_from<kBatch>(first[m * kBatch]);
    // Lane k is entry n k + i of all: in part m or in another.
    column[i] = __builtin_shufflevector(m == 0 ? part : column[i], part,
                                        ((n * k + i) / kBatch == m ? kBatch + (n * k + i) % kBatch : k)...);
  };
  const auto merge_all = [&]<int... im>(std::integer_sequence<int, im...>) __attribute__((always_inline)) {
    (merge(std::integral_constant<int, im / n>{}, std::integral_constant<int, im % n>{},
           std::make_integer_sequence<int, kBatch>{}),
     ...);
  };
  merge_all(std::make_integer_sequence<int, n * n>{});
  return column;
}

}  // namespace batch

/// Some points of one cell. Lanes beyond `count` hold some point's values.
template <int D>
struct PointBatch {
  int count = 0;
  std::array<std::uint32_t, kBatch> point;
  bool in_a_row = false;  ///< one after the other in memory, with others behind them up to a full batch

  PointBatch(const BlockList& list, PointRange range) {
    count = static_cast<int>(std::min<std::uint32_t>(kBatch, range.end - range.begin));
    const std::uint32_t* from = &list.order[range.begin];
    for (int k = 0; k < kBatch; ++k) point[k] = from[k < count ? k : 0];
    in_a_row = from[count - 1] - from[0] == static_cast<std::uint32_t>(count - 1) &&
               from[0] + kBatch <= list.order.size();
  }
  /// v in the lanes of these points, else 0.
  QUICKSAND_INLINE BatchLanes only(const BatchLanes& v) const {
    const BatchLanes lane{0, 1, 2, 3, 4, 5, 6, 7};
    return where(lane < count, v, BatchLanes{});
  }
  /// Of an array of numbers.
  QUICKSAND_INLINE BatchLanes get(const std::vector<double>& from) const {
    if (in_a_row) return lanes_from<kBatch>(from[point[0]]);
    BatchLanes v;
    for (int k = 0; k < kBatch; ++k) v[k] = from[point[k]];
    return v;
  }
  QUICKSAND_INLINE void put(const BatchLanes& v, std::vector<double>& to) const {
    for (int k = 0; k < count; ++k) to[point[k]] = v[k];
  }
  /// Of an array of vectors, component by component.
  template <std::size_t n>
  QUICKSAND_INLINE std::array<BatchLanes, n> get(const std::vector<std::array<double, n>>& from) const {
    if (in_a_row) return batch::columns<static_cast<int>(n)>(from[point[0]].data());
    std::array<BatchLanes, n> v;
    for (int k = 0; k < kBatch; ++k)
      for (std::size_t i = 0; i < n; ++i) v[i][k] = from[point[k]][i];
    return v;
  }
  template <std::size_t n>
  QUICKSAND_INLINE void put(const std::array<BatchLanes, n>& v,
                            std::vector<std::array<double, n>>& to) const {
    for (int k = 0; k < count; ++k)
      for (std::size_t i = 0; i < n; ++i) to[point[k]][i] = v[i][k];
  }
};

/// f(cell, its batch of points) for the points of block b.
template <int D, class F>
void for_batches(const Blocks<D>& blocks, const BlockList& list, int b, F&& f) {
  blocks.cells_with_points(list, b, [&](const Cell<D>& cell, PointRange points) {
    for (; points.begin < points.end; points.begin += kBatch) f(cell, PointBatch<D>(list, points));
  });
}

}  // namespace quicksand
