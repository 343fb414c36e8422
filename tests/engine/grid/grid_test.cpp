#include "engine/grid/grid.hpp"

#include <gtest/gtest.h>

#include <set>

namespace quicksand {
namespace {

TEST(Grid, IndexAndCellAreInverseInThePlane) {
  const Grid<2> grid({-1, 2}, {7, 5}, 0.25);
  ASSERT_EQ(grid.count(), 11 * 9);
  std::set<Cell<2>> seen;
  for (int i = 0; i < grid.count(); ++i) {
    const Cell<2> c = grid.cell(i);
    EXPECT_EQ(grid.index(c), i);
    EXPECT_TRUE(c[0] >= -2 && c[0] < 9 && c[1] >= -2 && c[1] < 7);
    seen.insert(c);
  }
  EXPECT_EQ(seen.size(), 99u);
}

TEST(Grid, IndexAndCellAreInverseInSpace) {
  const Grid<3> grid({0, 0, 0}, {3, 5, 4}, 0.1);
  ASSERT_EQ(grid.count(), 7 * 9 * 8);
  std::set<Cell<3>> seen;
  for (int i = 0; i < grid.count(); ++i) {
    EXPECT_EQ(grid.index(grid.cell(i)), i);
    seen.insert(grid.cell(i));
  }
  EXPECT_EQ(seen.size(), 7u * 9 * 8);
}

TEST(Grid, NeighboursAreOneStrideApart) {
  const Grid<3> grid({0, 0, 0}, {3, 5, 4}, 0.1);
  for (int d = 0; d < 3; ++d) {
    Cell<3> c{1, 2, 1}, next = c;
    ++next[d];
    EXPECT_EQ(grid.index(next) - grid.index(c), grid.stride[d]);
  }
}

TEST(Grid, CellOfFindsTheCentreAndClampsOutside) {
  const Grid<2> grid({-1, 2}, {7, 5}, 0.25);
  for_each_cell(grid, [&](int i, const Cell<2>& c) {
    EXPECT_EQ(grid.cell_of(grid.center(c)), c);
    EXPECT_EQ(grid.index(c), i);
    EXPECT_TRUE(grid.inside(c));
  });
  EXPECT_EQ(grid.cell_of({-5, 100}), (Cell<2>{0, 4}));
  EXPECT_EQ(grid.cell_of({5, -100}), (Cell<2>{6, 0}));
  EXPECT_FALSE(grid.inside({-1, 0}));
  EXPECT_FALSE(grid.inside({0, 5}));
}

TEST(Grid, ForEachCellVisitsTheDomainOnceInIncreasingOrder) {
  const Grid<3> grid({0, 0, 0}, {3, 2, 4}, 0.5);
  int last = -1, count = 0;
  for_each_cell(grid, [&](int i, const Cell<3>& c) {
    EXPECT_GT(i, last);
    EXPECT_EQ(grid.index(c), i);
    last = i;
    ++count;
  });
  EXPECT_EQ(count, 24);
}

TEST(Grid, VolumesAndAreas) {
  EXPECT_DOUBLE_EQ((Grid<2>({0, 0}, {1, 1}, 0.1).cell_volume()), 0.01);
  EXPECT_DOUBLE_EQ((Grid<3>({0, 0, 0}, {1, 1, 1}, 0.1).cell_volume()), 0.001);
  EXPECT_DOUBLE_EQ((Grid<2>({0, 0}, {1, 1}, 0.1).face_area()), 0.1);
  EXPECT_DOUBLE_EQ((Grid<3>({0, 0, 0}, {1, 1, 1}, 0.1).face_area()), 0.01);
}

}  // namespace
}  // namespace quicksand
