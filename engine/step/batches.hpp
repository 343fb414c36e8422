#pragma once
// Loops over the points of a block, cell by cell, some at a time with their weights.

#include <algorithm>

#include "engine/grid/cell_kernel.hpp"
#include "engine/grid/shuffles.hpp"
#include "engine/points/blocks.hpp"

namespace quicksand {

/// Some points of one or two cells of a block: those of the first, then those of the second. Lanes beyond
/// `count` hold zeros or the first one's values.
template <int D>
struct PointBatch {
  /// In space a cell's points fill the lanes by themselves, and two windows cost more than lanes left empty.
  static constexpr bool kPairs = D == 2;
  int count = 0, cells = 1;
  std::array<Cell<D>, 2> cell{};  ///< the same twice if it is one
  std::array<int, 2> end{};       ///< lane behind the last point of each cell
  std::array<std::uint32_t, kBatch> point;
  bool in_a_row = false;  ///< one after the other in memory

  void fill(const std::uint32_t* from) {
    if (count == kBatch)
      std::copy_n(from, kBatch, point.begin());
    else
      for (int k = 0; k < kBatch; ++k) point[k] = from[k < count ? k : 0];
    // Those of each cell ascend.
    const int last = end[0] - 1;
    in_a_row = from[last] - from[0] == static_cast<std::uint32_t>(last);
    if (cells == 2)
      in_a_row = in_a_row && from[end[0]] - from[last] == 1 &&
                 from[count - 1] - from[0] == static_cast<std::uint32_t>(count - 1);
  }
  /// Which of the cells point k lies in.
  int cell_of(int k) const { return kPairs && k >= end[0]; }
  /// `first` in the lanes of the first cell's points, `second` in those of the other.
  QUICKSAND_INLINE BatchLanes by_cell(double first, double second) const {
    if constexpr (!kPairs) return all_lanes<BatchLanes>(first);
    return where(lane_numbers() < end[0], all_lanes<BatchLanes>(first), all_lanes<BatchLanes>(second));
  }
  /// Coordinates of the points' cells.
  QUICKSAND_INLINE std::array<BatchLanes, D> places() const {
    std::array<BatchLanes, D> at;
    each<D>([&](auto d) __attribute__((always_inline)) { at[d] = by_cell(cell[0][d], cell[1][d]); });
    return at;
  }
  /// Whether the lanes are points that lie one after the other, all of them.
  bool full() const { return in_a_row && count == kBatch; }
  /// v in the lanes of these points, else 0.
  QUICKSAND_INLINE BatchLanes only(const BatchLanes& v) const {
    return where(lane_numbers() < count, v, BatchLanes{});
  }
  /// Of an array of numbers.
  QUICKSAND_INLINE BatchLanes get(const std::vector<double>& from) const {
    if (in_a_row) return some_lanes_from(&from[point[0]], count);
    return lanes_of<kBatch>([&](int k) { return from[point[k]]; });
  }
  QUICKSAND_INLINE void put(const BatchLanes& v, std::vector<double>& to) const {
    if (full()) return put_lanes<kBatch>(to[point[0]], v);
    const Kept<> kept = v;
    for (int k = 0; k < count; ++k) to[point[k]] = kept[k];
  }
  /// Of an array of vectors, component by component.
  template <std::size_t n>
  QUICKSAND_INLINE std::array<BatchLanes, n> get(const std::vector<std::array<double, n>>& from) const {
    if (in_a_row) return columns<static_cast<int>(n)>(from[point[0]].data(), count);
    std::array<BatchLanes, n> v;
    each<static_cast<int>(n)>([&](auto i) __attribute__((always_inline)) {
      v[i] = lanes_of<kBatch>([&](int k) { return from[point[k]][i]; });
    });
    return v;
  }
  template <std::size_t n>
  QUICKSAND_INLINE void put(const std::array<BatchLanes, n>& v,
                            std::vector<std::array<double, n>>& to) const {
    if constexpr (n == 2 || n == 4)
      if (full()) return put_columns<static_cast<int>(n)>(v, to[point[0]].data());
    std::array<Kept<>, n> kept;
    each<static_cast<int>(n)>([&](auto i) __attribute__((always_inline)) { kept[i] = v[i]; });
    for (int k = 0; k < count; ++k)
      for (std::size_t i = 0; i < n; ++i) to[point[k]][i] = kept[i][k];
  }
};

/// The points of a block in batches. Beside the last ones of a cell goes the next cell, if all of it fits:
/// most of what a batch writes is once per cell, however few of its points it holds.
template <int D>
class BatchWalk {
 public:
  BatchWalk(const Blocks<D>& blocks, const BlockList& list, int block)
      : list_(list), low_(blocks.low(block)), begin_(&list.begin[block * std::size_t{Blocks<D>::kCells}]) {
    at_ = begin_[0];
  }
  /// False when there are no more.
  bool next(PointBatch<D>& batch) {
    const std::uint32_t last = begin_[Blocks<D>::kCells];
    if (at_ == last) return false;
    go_to(at_);
    const std::uint32_t first = std::min(begin_[cell_ + 1], at_ + kBatch);
    batch.cell[0] = batch.cell[1] = Blocks<D>::cell(low_, cell_);
    batch.end[0] = static_cast<int>(first - at_);
    std::uint32_t end = first;
    if (PointBatch<D>::kPairs && first < last) {
      go_to(first);
      if (begin_[cell_ + 1] - at_ <= kBatch) end = begin_[cell_ + 1];
      if (end > first) batch.cell[1] = Blocks<D>::cell(low_, cell_);
    }
    batch.cells = end > first ? 2 : 1;
    batch.count = batch.end[1] = static_cast<int>(end - at_);
    batch.fill(&list_.order[at_]);
    at_ = end;
    return true;
  }

 private:
  /// To the cell that holds the point at a place.
  void go_to(std::uint32_t place) {
    while (begin_[cell_ + 1] <= place) ++cell_;
  }

  const BlockList& list_;
  Cell<D> low_;  ///< of the block
  int cell_ = 0;
  const std::uint32_t* begin_;  ///< of the block's cells
  std::uint32_t at_ = 0;        ///< in BlockList::order
};

/// f(batch) for the points of block b.
template <int D, class F>
void for_batches(const Blocks<D>& blocks, const BlockList& list, int b, F&& f) {
  BatchWalk<D> walk(blocks, list, b);
  for (PointBatch<D> batch; walk.next(batch);) f(batch);
}

/// The windows of a batch's cells: the same twice if it is one.
template <int D>
struct BatchWindows {
  std::array<int, 2> home;
  std::array<CellWindow<D>, 2> window;
  BatchWindows(const Grid<D>& grid, const Walls<D>& walls, const PointBatch<D>& batch)
      : home{grid.index(batch.cell[0]), grid.index(batch.cell[1])},
        window{CellWindow<D>(grid, walls, home[0]), CellWindow<D>(grid, walls, home[1])} {}
  bool open() const { return window[0].open() && window[1].open(); }  ///< no wall is in reach
  /// f(window, lane of the first point, lane behind the last one) for each cell.
  template <class F>
  QUICKSAND_INLINE void each(const PointBatch<D>& batch, F&& f) const {
    f(window[0], 0, batch.end[0]);
    if (PointBatch<D>::kPairs && batch.cells == 2) f(window[1], batch.end[0], batch.end[1]);
  }
};

}  // namespace quicksand
