#pragma once
// Cubes of cells as the unit of work, of which those near points are active: all else is empty, and nobody
// goes there. Blocks in different tiles of one colour are far enough apart that their points write to
// different faces, so a scatter needs no atomics, and the order of every sum is fixed by the blocks alone:
// the result does not depend on the number of threads.

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/grid/field.hpp"
#include "engine/grid/grid.hpp"
#include "engine/points/tiles.hpp"
#include "engine/threads/parallel.hpp"

namespace quicksand {

/// Points of one set grouped by cell, block after block, in a reproducible order.
struct BlockList {
  std::vector<std::uint32_t> order;  ///< point indices
  std::vector<std::uint32_t> begin;  ///< per cell of the active blocks (Blocks::kCells each), and the end
  std::vector<int> key;              ///< per point, Blocks::key_of the cell that holds it
};

/// Some of the places in `order`.
struct PointRange {
  std::uint32_t begin = 0, end = 0;
};

template <int D>
class Blocks {
 public:
  static constexpr int kEdge = 4;  ///< cells; must exceed a kernel's reach of 3 faces
  static constexpr int kColors = Tiles<D>::kColors;
  static constexpr int kCells = D == 2 ? 16 : 64;  ///< of a block

  Blocks() = default;
  explicit Blocks(const Grid<D>& grid) : cells_(grid.cells) {
    int count = 1;
    for (int d = 0; d < D; ++d) {
      blocks_[d] = (grid.cells[d] + kEdge - 1) / kEdge;
      count *= blocks_[d];
    }
    number_ = Field<int>(count);
    held_ = Field<std::uint8_t>(count);
    tiles_ = Tiles<D>(blocks_);
  }

  /// Block that holds a cell, as its place in the domain.
  int block_of(const Cell<D>& c) const {
    int b = 0;
    for (int d = D - 1; d >= 0; --d) b = b * blocks_[d] + c[d] / kEdge;
    return b;
  }
  /// Which block holds a cell, and where in it: place × kCells + number. Numbers count along y, then z, then
  /// x: a scatter that writes rows along x finds the same rows again in the next cell, and not parts of two
  /// that it has just written, for which a processor has to wait.
  int key_of(const Cell<D>& c) const {
    int at = 0;
    for (int d = 0; d < D; ++d) at = at * kEdge + c[kOrder[d]] % kEdge;
    return block_of(c) * kCells + at;
  }
  /// A block that is always active.
  void pin(int block) { pinned_.push_back(block); }

  /// Cells of points, into `list.key`.
  void locate(const Grid<D>& grid, const std::vector<Vec<D>>& x, BlockList& list) const {
    list.key.resize(x.size());
    parallel_parts(x.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) list.key[p] = key_of(grid.cell_of(x[p]));
    });
  }

  /// Makes those blocks active that hold located points or are pinned, with the blocks around them: no kernel
  /// reaches further, nor does a point in a step. Returns the blocks that are no longer active.
  std::vector<int> activate(std::initializer_list<const BlockList*> lists) {
    std::vector<int> holding;
    bool as_before = true;
    const auto hold = [&](int b) {
      if (held_[b] & kHolds) return;
      as_before = as_before && held_[b] == kHeld;
      held_[b] |= kHolds;
      holding.push_back(b);
    };
    for (const BlockList* list : lists)
      for (const int b : blocks_of(list->key)) hold(b);
    for (const int b : pinned_) hold(b);
    as_before = as_before && holding.size() == holding_.size();
    for (const int b : holding_) held_[b] = 0;
    for (const int b : holding) held_[b] = kHeld;
    holding_ = std::move(holding);
    if (as_before) return {};
    const std::vector<int> before = clear();
    for (const int b : holding_) add_around(b);
    std::sort(active_.begin(), active_.end());
    number();
    std::vector<int> left;
    std::set_difference(before.begin(), before.end(), active_.begin(), active_.end(),
                        std::back_inserter(left));
    return left;
  }

  /// Places of the active blocks, ascending.
  const std::vector<int>& active() const { return active_; }
  /// Makes just these active. Throws std::out_of_range for a place outside the domain.
  void adopt(std::vector<int> places) {
    for (const int b : places) std::ignore = number_.at(b);
    for (const int b : holding_) held_[b] = 0;
    holding_.clear();
    clear();
    active_ = std::move(places);
    number();
  }

  /// Groups located points by cell of the active blocks (stable counting sort of their indices). Every part
  /// of the points counts for itself, so that their order does not depend on the number of parts.
  void group(BlockList& list) const {
    const auto slot = [&](int key) { return (number_[key / kCells] - 1) * kCells + key % kCells; };
    const std::size_t slots = static_cast<std::size_t>(count()) * kCells, parts = parts_of(list.key.size());
    if (list.key.empty()) {  // a phase that the scene does not have
      list.order.clear();
      if (list.begin.size() != slots + 1 || list.begin.back() != 0) list.begin.assign(slots + 1, 0);
      return;
    }
    // Per part and cell: how many points; then the place of the next one.
    const auto next = std::make_unique_for_overwrite<std::uint32_t[]>(parts * slots);
    for_parts(list.key, parts, [&](std::size_t part, auto&& stretches) {
      std::uint32_t* mine = &next[part * slots];
      std::fill(mine, mine + slots, 0);
      stretches([&](int key, std::size_t from, std::size_t to) {
        mine[slot(key)] += static_cast<std::uint32_t>(to - from);
      });
    });
    std::vector<std::uint32_t> first(count() + 1);  // of the blocks
    all([&](int b) {
      for (std::size_t part = 0; part < parts; ++part)
        for (int k = 0; k < kCells; ++k) first[b + 1] += next[part * slots + b * kCells + k];
    });
    for (int b = 0; b < count(); ++b) first[b + 1] += first[b];
    list.begin.resize(slots + 1);
    all([&](int b) {
      std::uint32_t at = first[b];
      for (std::size_t i = b * std::size_t{kCells}, end = i + kCells; i < end; ++i) {
        list.begin[i] = at;
        for (std::size_t part = 0; part < parts; ++part) at += std::exchange(next[part * slots + i], at);
      }
    });
    list.begin[slots] = first.back();
    list.order.resize(list.key.size());
    for_parts(list.key, parts, [&](std::size_t part, auto&& stretches) {
      stretches([&](int key, std::size_t from, std::size_t to) {
        std::uint32_t& place = next[part * slots + slot(key)];
        for (std::size_t p = from; p < to; ++p) list.order[place++] = static_cast<std::uint32_t>(p);
      });
    });
  }
  /// Grouped points of an active block.
  PointRange points(const BlockList& list, int number) const {
    const auto first = static_cast<std::size_t>(number) * kCells;
    return {list.begin[first], list.begin[first + kCells]};
  }
  /// The lowest cell of an active block.
  Cell<D> low(int number) const { return low_cell(active_[number]); }
  /// Cell k of the block whose lowest cell is c, in the order of BlockList::begin.
  static Cell<D> cell(Cell<D> c, int k) {
    for (int d = D - 1; d >= 0; k /= kEdge, --d) c[kOrder[d]] += k % kEdge;
    return c;
  }

  /// Whether the active block before this one is its neighbour along x.
  bool beside(int number) const {
    return active_[number] == active_[number - 1] + 1 && active_[number] % blocks_[0] != 0;
  }

  /// Active blocks. From here on a block is its number among them, in the order of their places.
  int count() const { return static_cast<int>(active_.size()); }
  /// Number of an active block, from its place; −1 if it is not active.
  int number_of(int block) const { return number_[block] - 1; }

  /// f(number) for all active blocks, tile by tile, one colour after the other.
  template <class F>
  void by_color(F&& f) const {
    tiles_.by_color(f);
  }
  const Tiles<D>& tiles() const { return tiles_; }
  /// f(number) for all active blocks in any order.
  template <class F>
  void all(F&& f) const {
    parallel(active_.size(), [&](std::size_t i) { f(static_cast<int>(i)); });
  }
  /// Σ f(number) in a fixed order.
  template <class T, class F>
  T sum(F&& f) const {
    constexpr std::size_t some = 4;  // blocks that one thread adds up
    std::vector<T> partial((active_.size() + some - 1) / some);
    parallel(partial.size(), [&](std::size_t i) {
      for (std::size_t b = i * some; b < std::min(active_.size(), (i + 1) * some); ++b)
        partial[i] += f(static_cast<int>(b));
    });
    T total{};
    for (const T& p : partial) total += p;
    return total;
  }
  /// f(index, cell) for the cells of an active block, and for the faces on its upper sides if it is a last
  /// block (`with_upper_faces`), so that every face of the domain is visited once.
  template <class F>
  void cells(const Grid<D>& grid, int number, bool with_upper_faces, F&& f) const {
    cells_at(grid, active_[number], with_upper_faces, f);
  }
  /// The same for a block by its place.
  template <class F>
  void cells_at(const Grid<D>& grid, int block, bool with_upper_faces, F&& f) const {
    const Cell<D> low = low_cell(block);
    Cell<D> high;
    for (int d = 0; d < D; ++d) {
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
  /// Axes, the one along which numbers of cells grow fastest last.
  static constexpr std::array<int, 3> kOrder =
      D == 2 ? std::array<int, 3>{0, 1, 0} : std::array<int, 3>{0, 2, 1};

  Cell<D> low_cell(int block) const {
    Cell<D> low;
    for (int d = 0; d < D; block /= blocks_[d], ++d) low[d] = block % blocks_[d] * kEdge;
    return low;
  }
  template <class F>
  static void parallel(std::size_t n, F&& f) {
    parallel_parts(n, 2, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) f(i);
    });
  }
  /// Parts in which threads go through points, where each needs room for all cells.
  static std::size_t parts_of(std::size_t points) {
    constexpr std::size_t least = 16384, most = 8;
    return std::clamp<std::size_t>(points / least, 1, std::min<std::size_t>(most, thread_count()));
  }
  /// f(part, stretches) for the parts, by one thread each; stretches(g): g(key, from, to) for stretches of
  /// equal keys, which are long where points lie in the order of blocks.
  template <class F>
  static void for_parts(const std::vector<int>& key, std::size_t parts, F&& f) {
    parallel_parts(parts, 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t part = first; part < last; ++part)
        f(part, [&](auto&& g) {
          const std::size_t end = key.size() * (part + 1) / parts;
          for (std::size_t from = key.size() * part / parts, to; from < end; from = to) {
            for (to = from + 1; to < end && key[to] == key[from];) ++to;
            g(key[from], from, to);
          }
        });
    });
  }
  /// Blocks that hold located points, some of them more than once.
  static std::vector<int> blocks_of(const std::vector<int>& key) {
    std::vector<std::vector<int>> found(parts_of(key.size()));
    for_parts(key, found.size(), [&](std::size_t part, auto&& stretches) {
      std::vector<int>& mine = found[part];
      stretches([&](int k, std::size_t, std::size_t) {
        if (mine.empty() || mine.back() != k / kCells) mine.push_back(k / kCells);
      });
    });
    for (std::size_t part = 1; part < found.size(); ++part)
      found[0].insert(found[0].end(), found[part].begin(), found[part].end());
    return found[0];
  }
  /// Returns the blocks that were active; none are.
  std::vector<int> clear() {
    std::vector<int> before = std::move(active_);
    active_.clear();
    for (const int b : before) number_[b] = 0;
    return before;
  }
  /// Numbers and tiles of the active blocks.
  void number() {
    for (int i = 0; i < count(); ++i) number_[active_[i]] = i + 1;
    tiles_.make(active_);
  }
  /// Adds a block and those around it to the active ones, once each.
  void add_around(int block) {
    Cell<D> at;
    for (int d = 0, rest = block; d < D; rest /= blocks_[d], ++d) at[d] = rest % blocks_[d];
    for (int k = 0, around = D == 2 ? 9 : 27; k < around; ++k) {
      int b = 0, scale = 1;
      bool inside = true;
      for (int d = 0, rest = k; d < D; rest /= 3, scale *= blocks_[d], ++d) {
        const int c = at[d] + rest % 3 - 1;
        inside = inside && c >= 0 && c < blocks_[d];
        b += c * scale;
      }
      if (!inside || number_[b]) continue;
      number_[b] = 1;
      active_.push_back(b);
    }
  }

  Cell<D> cells_{}, blocks_{};
  std::vector<int> active_, pinned_;  ///< places
  Field<int> number_;                 ///< per place, 1 + number of an active block; 0: not active
  std::vector<int> holding_;          ///< places of blocks that held points when blocks became active
  Field<std::uint8_t> held_;          ///< per place, kHeld if it is among them
  static constexpr std::uint8_t kHeld = 1, kHolds = 2;
  Tiles<D> tiles_;
};

}  // namespace quicksand
