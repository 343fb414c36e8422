#pragma once
// Neighbouring blocks that one thread goes through in a row: what they have in common is then still in its
// cache, where colours of single blocks come back to the same faces from memory, colour after colour.

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/grid/field.hpp"
#include "engine/grid/grid.hpp"
#include "engine/threads/parallel.hpp"

namespace quicksand {

/// Tiles of one colour lie a tile apart. How large they are follows from how many blocks there are, so that
/// all threads find some of each colour; like their order it does not depend on the threads.
template <int D>
class Tiles {
 public:
  static constexpr int kColors = 1 << D;

  Tiles() = default;
  explicit Tiles(const Cell<D>& blocks) : blocks_(blocks) {
    int count = 1;
    for (const int n : blocks) count *= n;
    number_ = Field<int>(count);
  }

  /// Blocks by their places in the domain, ascending.
  void make(const std::vector<int>& places) {
    edge_ = edge_for(places.size());
    tiles_.clear();
    for (auto& of_color : of_color_) of_color.clear();
    std::vector<int> tile(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      tile[i] = tile_at(places[i]);
      ++tiles_[tile[i]].end;
    }
    int begin = 0;
    for (Tile& t : tiles_) {
      number_[t.place] = 0;
      begin += std::exchange(t.end, begin);
      t.begin = t.end;
    }
    order_.resize(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) order_[tiles_[tile[i]].end++] = static_cast<int>(i);
  }

  /// f(number) for all blocks, by their numbers in `places`, tile by tile, one colour after the other.
  template <class F>
  void by_color(F&& f) const {
    for (const auto& tiles : of_color_)
      parallel_parts(tiles.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
          for (int k = tiles_[tiles[i]].begin; k < tiles_[tiles[i]].end; ++k) f(order_[k]);
      });
  }
  /// Blocks along the edges of a tile.
  const Cell<D>& edge() const { return edge_; }
  /// Coordinates of the tile that holds a block at these.
  Cell<D> tile_of(const Cell<D>& block) const {
    Cell<D> tile;
    for (int d = 0; d < D; ++d) tile[d] = block[d] / edge_[d];
    return tile;
  }
  int color_of(const Cell<D>& block) const {
    const Cell<D> tile = tile_of(block);
    int color = 0;
    for (int d = 0; d < D; ++d) color |= (tile[d] % 2) << d;
    return color;
  }

 private:
  struct Tile {
    int place, begin, end;  ///< of its blocks, in `order_`
  };

  /// Rows first, as neighbours along x lie next to each other in memory.
  static Cell<D> edge_for(std::size_t blocks) {
    constexpr std::size_t tiles = 14 * kColors;  // fewer leave threads waiting, more write faces more often
    Cell<D> edge;
    edge.fill(1);
    std::size_t share = blocks / tiles;
    const auto twice = [&](int axis) {
      if (share >= 2) edge[axis] *= 2, share /= 2;
    };
    twice(0), twice(0);
    for (int d = 1; d < D; ++d) twice(d);
    twice(0), twice(0);
    return edge;
  }
  /// Number of the tile that holds the block at a place; a new one if there was none.
  int tile_at(int block) {
    Cell<D> at;
    for (int d = 0, rest = block; d < D; rest /= blocks_[d], ++d) at[d] = rest % blocks_[d];
    const Cell<D> tile = tile_of(at);
    int place = 0;
    for (int d = D - 1; d >= 0; --d) place = place * blocks_[d] + tile[d];
    if (number_[place] == 0) {
      of_color_[color_of(at)].push_back(static_cast<int>(tiles_.size()));
      tiles_.push_back({place, 0, 0});
      number_[place] = static_cast<int>(tiles_.size());
    }
    return number_[place] - 1;
  }

  Cell<D> blocks_{}, edge_{};
  std::vector<Tile> tiles_;  ///< by their first blocks
  std::vector<int> order_;   ///< blocks, tile after tile
  std::array<std::vector<int>, kColors> of_color_;
  Field<int> number_;  ///< per place, 1 + number of a tile while they are made; 0: none yet
};

}  // namespace quicksand
