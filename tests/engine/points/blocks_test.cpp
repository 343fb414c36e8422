#include "engine/points/blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <random>
#include <set>

#include "engine/grid/stencil.hpp"
#include "engine/step/batches.hpp"

namespace quicksand {
namespace {

template <int D>
Grid<D> uneven_grid() {
  Cell<D> count;
  for (int d = 0; d < D; ++d) count[d] = D == 2 ? 13 - 4 * d : 9 - 3 * d;  // 13×9 and 9×6×3
  return Grid<D>(Vec<D>{}, count, 0.1);
}

/// A point in the middle of every cell of which `f` is true.
template <int D, class F>
std::vector<Vec<D>> middles(const Grid<D>& grid, F&& f) {
  std::vector<Vec<D>> x;
  for_each_cell(grid, [&](int, const Cell<D>& c) {
    if (f(c)) x.push_back(grid.center(c));
  });
  return x;
}

/// Blocks around points.
template <int D>
Blocks<D> blocks_at(const Grid<D>& grid, const std::vector<Vec<D>>& x, BlockList& list) {
  Blocks<D> blocks(grid);
  blocks.locate(grid, x, list);
  blocks.activate({&list});
  return blocks;
}

template <int D>
Blocks<D> all_blocks(const Grid<D>& grid) {
  BlockList list;
  return blocks_at<D>(grid, middles(grid, [](const Cell<D>&) { return true; }), list);
}

template <int D>
void expect_cells_once(const Grid<D>& grid) {
  const Blocks<D> blocks = all_blocks(grid);
  std::map<int, int> block_of;
  for (int b = 0; b < blocks.count(); ++b)
    blocks.cells(grid, b, false, [&](int i, const Cell<D>& c) {
      EXPECT_TRUE(block_of.emplace(i, b).second);
      EXPECT_EQ(grid.index(c), i);
      EXPECT_EQ(blocks.number_of(blocks.block_of(c)), b);
    });
  int inside = 0;
  for_each_cell(grid, [&](int i, const Cell<D>&) {
    ++inside;
    EXPECT_TRUE(block_of.count(i));
  });
  EXPECT_EQ(static_cast<int>(block_of.size()), inside);
}

template <int D>
void expect_faces_once(const Grid<D>& grid) {
  const Blocks<D> blocks = all_blocks(grid);
  std::map<int, int> visits;
  for (int b = 0; b < blocks.count(); ++b)
    blocks.cells(grid, b, true, [&](int i, const Cell<D>& c) {
      ++visits[i];
      EXPECT_EQ(grid.index(c), i);
    });
  int faces = 1;
  for (int d = 0; d < D; ++d) faces *= grid.cells[d] + 1;
  EXPECT_EQ(static_cast<int>(visits.size()), faces);
  for (const auto& [face, n] : visits) EXPECT_EQ(n, 1) << face;
}

TEST(Blocks, EachCellIsInOneBlock) {
  expect_cells_once(uneven_grid<2>());
  expect_cells_once(uneven_grid<3>());
  expect_cells_once(Grid<2>({0, 0}, {1, 8}, 1));  // thinner than a block
}

TEST(Blocks, EachFaceIsVisitedOnce) {
  expect_faces_once(uneven_grid<2>());
  expect_faces_once(uneven_grid<3>());
  expect_faces_once(Grid<2>({0, 0}, {4, 8}, 1));  // ends on a block's edge
}

/// Coordinates of a block.
template <int D>
Cell<D> place_of(const Blocks<D>& blocks, int number) {
  Cell<D> at = blocks.low(number);
  for (int& c : at) c /= Blocks<D>::kEdge;
  return at;
}

/// Runs by_color on one thread and tells the tiles of each colour apart by what they may write to.
template <int D>
void expect_colors_apart(const Grid<D>& grid) {
  const Blocks<D> blocks = all_blocks(grid);
  using Tile = std::array<int, D>;
  std::array<std::map<int, Tile>, Blocks<D>::kColors> writer;  // target → tile
  const Walls<D> open(grid);
  std::vector<int> colors;
  int done = 0;
  const Tiles<D>& tiles = blocks.tiles();
  const auto visit = [&](int b) {
    ++done;
    const int color = tiles.color_of(place_of(blocks, b));
    if (colors.empty() || colors.back() != color) colors.push_back(color);
    const Tile tile = tiles.tile_of(place_of(blocks, b));
    blocks.cells(grid, b, false, [&](int, const Cell<D>& c) {
      for (const double side : {0.01, 0.99}) {
        Vec<D> x;
        for (int d = 0; d < D; ++d) x[d] = grid.origin[d] + (c[d] + side) * grid.h;
        const PointKernel<D> kernel(grid, x);
        const auto note = [&](int target) {
          const auto [at, fresh] = writer[color].emplace(target, tile);
          EXPECT_TRUE(fresh || at->second == tile);
        };
        for (int d = 0; d < D; ++d)
          for_faces(grid, open, kernel, d, [&](int f, double, double, const Vec<D>&) { note(f); });
        for_centers(grid, open, kernel, [&](int cell, double) { note(cell); });
      }
    });
  };
  with_threads(1, [&] { blocks.by_color(visit); });
  EXPECT_EQ(done, blocks.count());
  // One colour after the other: none comes back once left.
  EXPECT_TRUE(std::is_sorted(colors.begin(), colors.end()));
  EXPECT_EQ(static_cast<int>(colors.size()), Blocks<D>::kColors);
}

TEST(Blocks, ColoursShareNoFaceWithinReach2D) { expect_colors_apart(uneven_grid<2>()); }
TEST(Blocks, ColoursShareNoFaceWithinReach3D) { expect_colors_apart(Grid<3>({0, 0, 0}, {13, 9, 9}, 1)); }
TEST(Blocks, ColoursOfLargeTilesShareNoFaceWithinReach) {
  const Grid<2> plane({0, 0}, {200, 120}, 1);
  EXPECT_EQ(all_blocks(plane).tiles().edge(), (Cell<2>{8, 2}));
  expect_colors_apart(plane);
  const Grid<3> space({0, 0, 0}, {48, 32, 24}, 1);
  EXPECT_EQ(all_blocks(space).tiles().edge(), (Cell<3>{4, 1, 1}));
  expect_colors_apart(space);
}

TEST(Blocks, ATilesBlocksFollowEachOtherInRows) {
  const Blocks<2> blocks = all_blocks(Grid<2>({0, 0}, {200, 120}, 1));
  std::vector<int> order;
  with_threads(1, [&] { blocks.by_color([&](int b) { order.push_back(b); }); });
  const Cell<2> edge = blocks.tiles().edge();
  for (int k = 0; k < edge[0] * edge[1]; ++k)
    EXPECT_EQ(place_of(blocks, order[k]), (Cell<2>{k % edge[0], k / edge[0]}));
}

TEST(Blocks, ByColorAndAllVisitEveryBlockOnce) {
  const Blocks<3> blocks = all_blocks(uneven_grid<3>());
  std::mutex mutex;
  std::multiset<int> colored, all;
  blocks.by_color([&](int b) {
    const std::lock_guard lock(mutex);
    colored.insert(b);
  });
  blocks.all([&](int b) {
    const std::lock_guard lock(mutex);
    all.insert(b);
  });
  std::multiset<int> expected;
  for (int b = 0; b < blocks.count(); ++b) expected.insert(b);
  EXPECT_EQ(colored, expected);
  EXPECT_EQ(all, expected);
}

TEST(Blocks, SumIsTakenInTheOrderOfTheBlocks) {
  const Blocks<2> blocks = all_blocks(Grid<2>({0, 0}, {80, 80}, 1));
  const auto part = [](int b) { return std::pow(-1.7, b % 40); };
  double serial = 0;
  for (int b = 0; b < blocks.count(); ++b) serial += part(b);
  for (const int threads : {1, 2, 4})
    with_threads(threads, [&] { EXPECT_EQ(blocks.sum<double>(part), serial); });
}

TEST(Blocks, GroupIsAStableSort) {
  const Grid<2> grid = uneven_grid<2>();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(0, 1.3), y(0, 0.9);
  std::vector<Vec<2>> places(20000);
  for (auto& p : places) p = {x(random), y(random)};
  BlockList list;
  Blocks<2> blocks = blocks_at<2>(grid, places, list);
  blocks.group(list);
  ASSERT_EQ(static_cast<int>(list.begin.size()), blocks.count() * Blocks<2>::kCells + 1);
  EXPECT_EQ(list.begin.front(), 0u);
  EXPECT_EQ(list.begin.back(), places.size());
  std::vector<char> seen(places.size(), 0);
  for (int b = 0; b < blocks.count(); ++b) {
    PointRange rest = blocks.points(list, b);
    for (int k = 0; k < Blocks<2>::kCells; ++k) {
      const std::size_t at = static_cast<std::size_t>(b) * Blocks<2>::kCells + k;
      const PointRange points{list.begin[at], list.begin[at + 1]};
      const Cell<2> c = Blocks<2>::cell(blocks.low(b), k);
      EXPECT_EQ(points.begin, rest.begin);  // cell after cell
      rest.begin = points.end;
      EXPECT_EQ(blocks.number_of(blocks.block_of(c)), b);
      for (auto i = points.begin; i < points.end; ++i) {
        const auto p = list.order[i];
        EXPECT_EQ(grid.cell_of(places[p]), c);
        if (i > points.begin) {
          EXPECT_LT(list.order[i - 1], p);
        }
        EXPECT_FALSE(seen[p]);
        seen[p] = 1;
      }
    }
    EXPECT_EQ(rest.begin, rest.end);
  }
  blocks.locate(grid, {}, list);
  blocks.group(list);  // an empty set leaves nothing behind
  EXPECT_TRUE(list.order.empty());
  EXPECT_EQ(list.begin.back(), 0u);
}

/// Sparse and crowded cells: batches go through all points in order, a second cell is in them whole.
TEST(Blocks, BatchesOfOneOrTwoCellsHoldEveryPointOnce) {
  const Grid<2> grid = uneven_grid<2>();
  std::mt19937 random(4);
  std::uniform_real_distribution<double> part(0, 1);
  std::vector<Vec<2>> places(700);
  for (auto& p : places) p = {1.3 * std::pow(part(random), 3), 0.9 * part(random)};
  std::sort(places.begin(), places.end(),
            [&](const Vec<2>& a, const Vec<2>& b) {  // most, but not all, in a row
              return a[0] + 0.05 * a[1] < b[0] + 0.05 * b[1];
            });
  BlockList list;
  Blocks<2> blocks = blocks_at<2>(grid, places, list);
  blocks.group(list);
  int pairs = 0, crowded = 0;
  for (int b = 0; b < blocks.count(); ++b) {
    PointRange rest = blocks.points(list, b);
    for_batches(blocks, list, b, [&](const PointBatch<2>& batch) {
      ASSERT_GT(batch.count, 0);
      if (batch.cells == 2) {
        const int second = blocks.key_of(batch.cell[1]);
        EXPECT_EQ(batch.end[1] - batch.end[0], std::count(list.key.begin(), list.key.end(), second));
      } else if (rest.begin + batch.count < rest.end && batch.count < kBatch) {  // the next one did not fit
        const int next = list.key[list.order[rest.begin + batch.count]];
        EXPECT_GT(batch.count + std::count(list.key.begin(), list.key.end(), next), kBatch);
      }
      EXPECT_EQ(batch.end[1], batch.count);
      pairs += batch.cells == 2;
      crowded += batch.cells == 1 && batch.count == kBatch;
      bool in_a_row = true;
      for (int k = 0; k < batch.count; ++k) {
        EXPECT_EQ(batch.point[k], list.order[rest.begin++]);
        EXPECT_EQ(grid.cell_of(places[batch.point[k]]), batch.cell[batch.cell_of(k)]);
        in_a_row = in_a_row && batch.point[k] == batch.point[0] + k;
        for (int d = 0; d < 2; ++d) EXPECT_EQ(batch.places()[d][k], batch.cell[batch.cell_of(k)][d]);
      }
      EXPECT_EQ(batch.in_a_row, in_a_row);
    });
    EXPECT_EQ(rest.begin, rest.end);
  }
  EXPECT_GT(pairs, 20);
  EXPECT_GT(crowded, 20);
}

/// What is got of points is what they hold, and what is put reaches them alone: in a row or not, few or many.
template <std::size_t n>
void expect_batches_get_and_put() {
  std::vector<std::uint32_t> in_a_row(20), scattered(20);
  for (std::uint32_t k = 0; k < 20; ++k) in_a_row[k] = k, scattered[k] = k < 10 ? 2 * k : 2 * k - 19;
  for (const auto& order : {in_a_row, scattered})
    for (int count = 1; count <= kBatch; ++count) {
      std::vector<std::array<double, n>> vectors(20), put(20);
      std::vector<double> numbers(20), put_numbers(20);
      for (std::size_t p = 0; p < 20; ++p) {
        numbers[p] = 1 + static_cast<double>(p);
        for (std::size_t i = 0; i < n; ++i) vectors[p][i] = 100 * numbers[p] + static_cast<double>(i);
      }
      PointBatch<2> batch;
      batch.count = batch.end[0] = batch.end[1] = count;
      batch.fill(&order[3]);
      EXPECT_EQ(batch.in_a_row, count == 1 || order == in_a_row);
      batch.put(batch.get(vectors), put);
      batch.put(batch.get(numbers), put_numbers);
      for (std::size_t k = 0; k < 20; ++k) {
        const std::uint32_t p = order[k];
        const bool is_in = k >= 3 && k < 3 + static_cast<std::size_t>(count);
        EXPECT_EQ(put[p], is_in ? vectors[p] : (std::array<double, n>{})) << k << " of " << count;
        EXPECT_EQ(put_numbers[p], is_in ? numbers[p] : 0) << k << " of " << count;
      }
    }
}
TEST(Blocks, BatchesGetAndPutWhatPointsHold) {
  expect_batches_get_and_put<2>();
  expect_batches_get_and_put<3>();
  expect_batches_get_and_put<4>();
  expect_batches_get_and_put<6>();
}

/// 40 × 40 cells, 10 × 10 blocks.
const Grid<2> kSquare({0, 0}, {40, 40}, 1);

TEST(Blocks, ThoseAroundPointsAreActive) {
  BlockList list;
  Blocks<2> blocks = blocks_at<2>(kSquare, {{22, 14}}, list);  // in block (5, 3)
  ASSERT_EQ(blocks.count(), 9);
  for (int b = 0; b < blocks.count(); ++b)
    blocks.cells(kSquare, b, false, [&](int, const Cell<2>& c) {
      EXPECT_LE(std::abs(c[0] / 4 - 5), 1);
      EXPECT_LE(std::abs(c[1] / 4 - 3), 1);
    });
  EXPECT_EQ(blocks.number_of(blocks.block_of({22, 14})), 4);
  EXPECT_EQ(blocks.number_of(blocks.block_of({39, 39})), -1);
  blocks_at<2>(kSquare, {{0.5, 0.5}}, list);
  EXPECT_EQ(blocks_at<2>(kSquare, {{0.5, 0.5}}, list).count(), 4);  // in a corner
}

TEST(Blocks, ReportsThoseThatAreLeftBehind) {
  BlockList list;
  Blocks<2> blocks = blocks_at<2>(kSquare, {{22, 14}}, list);
  blocks.locate(kSquare, {{26, 14}}, list);  // one block to the right
  EXPECT_EQ(blocks.activate({&list}), (std::vector<int>{24, 34, 44}));
  EXPECT_EQ(blocks.count(), 9);
  EXPECT_TRUE(blocks.activate({&list}).empty());
  EXPECT_EQ(blocks.activate({}).size(), 9u);
  EXPECT_EQ(blocks.count(), 0);
}

TEST(Blocks, PinnedOnesStayActive) {
  Blocks<2> blocks(kSquare);
  blocks.pin(blocks.block_of({38, 38}));
  EXPECT_TRUE(blocks.activate({}).empty());
  EXPECT_EQ(blocks.count(), 4);
  EXPECT_TRUE(blocks.activate({}).empty());
}

}  // namespace
}  // namespace quicksand
