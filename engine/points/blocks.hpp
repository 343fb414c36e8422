#pragma once
// Cubes of cells as the unit of work. Blocks of one colour are far enough apart that their points write to
// different faces, so a scatter needs no atomics, and the order of every sum is fixed by the blocks alone:
// the result does not depend on the number of threads.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstdint>
#include <vector>

#include "engine/grid/grid.hpp"

namespace quicksand {

/// Points of one set grouped by block, in a reproducible order.
struct BlockList {
  std::vector<std::uint32_t> order;  ///< point indices
  std::vector<std::uint32_t> begin;  ///< per block, size blocks + 1
};

template <int D>
class Blocks {
 public:
  static constexpr int kEdge = 4;  ///< cells; must exceed a kernel's reach of 3 faces
  static constexpr int kColors = 1 << D;

  Blocks() = default;
  explicit Blocks(const Grid<D>& grid) : cells_(grid.cells) {
    count_ = 1;
    for (int d = 0; d < D; ++d) {
      blocks_[d] = (grid.cells[d] + kEdge - 1) / kEdge;
      count_ *= blocks_[d];
    }
    for (int b = 0; b < count_; ++b) {
      int color = 0;
      for (int d = 0, rest = b; d < D; rest /= blocks_[d], ++d) color |= (rest % blocks_[d] % 2) << d;
      of_color_[color].push_back(b);
    }
  }

  int count() const { return count_; }
  int block_of(const Cell<D>& c) const {
    int b = 0;
    for (int d = D - 1; d >= 0; --d) b = b * blocks_[d] + c[d] / kEdge;
    return b;
  }

  /// Groups points by block (stable counting sort of their indices).
  void group(const Grid<D>& grid, const std::vector<Vec<D>>& x, BlockList& list) const {
    std::vector<std::uint32_t>& key = scratch_;
    key.resize(x.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, x.size(), 4096), [&](const auto& range) {
      for (std::size_t p = range.begin(); p < range.end(); ++p)
        key[p] = static_cast<std::uint32_t>(block_of(grid.cell_of(x[p])));
    });
    list.begin.assign(count_ + 1, 0);
    for (std::uint32_t k : key) ++list.begin[k + 1];
    for (int b = 0; b < count_; ++b) list.begin[b + 1] += list.begin[b];
    list.order.resize(x.size());
    std::vector<std::uint32_t> next(list.begin.begin(), list.begin.end() - 1);
    for (std::size_t p = 0; p < x.size(); ++p) list.order[next[key[p]]++] = static_cast<std::uint32_t>(p);
  }

  /// f(block) for all blocks, one colour after the other.
  template <class F>
  void by_color(F&& f) const {
    for (const auto& blocks : of_color_) parallel(blocks.size(), [&](std::size_t i) { f(blocks[i]); });
  }
  /// f(block) for all blocks in any order.
  template <class F>
  void all(F&& f) const {
    parallel(count_, [&](std::size_t i) { f(static_cast<int>(i)); });
  }
  /// Σ f(block) in a fixed order.
  template <class T, class F>
  T sum(F&& f) const {
    std::vector<T> partial(count_);
    all([&](int b) { partial[b] = f(b); });
    T total{};
    for (const T& p : partial) total += p;
    return total;
  }
  /// f(index, cell) for the cells of a block, and for the faces on its upper sides if it is a last block
  /// (`with_upper_faces`), so that every face of the domain is visited once.
  template <class F>
  void cells(const Grid<D>& grid, int block, bool with_upper_faces, F&& f) const {
    Cell<D> low, high;
    for (int d = 0, rest = block; d < D; rest /= blocks_[d], ++d) {
      low[d] = rest % blocks_[d] * kEdge;
      high[d] = std::min(low[d] + kEdge, cells_[d]);
      if (with_upper_faces && high[d] == cells_[d]) ++high[d];
    }
    Cell<D> c = low;
    while (true) {
      int i = grid.index(c);
      for (c[0] = low[0]; c[0] < high[0]; ++c[0], ++i) f(i, c);
      c[0] = low[0];
      int d = 1;
      for (; d < D && ++c[d] == high[d]; ++d) c[d] = low[d];
      if (d == D) return;
    }
  }

 private:
  template <class F>
  static void parallel(std::size_t n, F&& f) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 2), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) f(i);
    });
  }

  Cell<D> cells_{}, blocks_{};
  int count_ = 0;
  std::array<std::vector<int>, kColors> of_color_;
  mutable std::vector<std::uint32_t> scratch_;
};

}  // namespace quicksand
