// Kernels at walls: what lies behind a closed face is mirrored in front of it.

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "engine/grid/stencil.hpp"

namespace quicksand {
namespace {

template <int D>
void close_domain(const Grid<D>& grid, Walls<D>& walls, bool no_slip = false) {
  for_each_cell(grid, [&](int i, const Cell<D>& c) {
    for (int d = 0; d < D; ++d) {
      if (c[d] == 0) walls.close(d, i, no_slip);
      if (c[d] == grid.cells[d] - 1) walls.close(d, i + grid.stride[d], no_slip);
    }
  });
}

/// Blocks the cells low ≤ c < high and closes their outline.
template <int D>
void add_block(const Grid<D>& grid, Walls<D>& walls, const Cell<D>& low, const Cell<D>& high) {
  const auto within = [&](const Cell<D>& c) {
    for (int d = 0; d < D; ++d)
      if (c[d] < low[d] || c[d] >= high[d]) return false;
    return true;
  };
  for_each_cell(grid, [&](int i, const Cell<D>& c) {
    if (!within(c)) return;
    walls.block(i);
    for (int d = 0; d < D; ++d) {
      Cell<D> below = c, above = c;
      --below[d], ++above[d];
      if (!within(below)) walls.close(d, i, false);
      if (!within(above)) walls.close(d, i + grid.stride[d], false);
    }
  });
}

/// What cells hold (in parts of a full cell) after all free cells were filled evenly, `per_axis` points each
/// way.
template <int D>
std::vector<double> uniform_filling(const Grid<D>& grid, const Walls<D>& walls, int per_axis) {
  std::vector<double> sums(grid.count(), 0);
  const double share = std::pow(per_axis, -D);
  for_each_cell(grid, [&](int i, const Cell<D>& c) {
    if (walls.blocked(i)) return;
    for (int k = 0; k < power(per_axis, D); ++k) {
      Vec<D> x;
      for (int d = 0, rest = k; d < D; ++d, rest /= per_axis)
        x[d] = grid.origin[d] + (c[d] + (rest % per_axis + 0.5) / per_axis) * grid.h;
      for_centers(grid, walls, PointKernel<D>(grid, x), [&](int cell, double w) { sums[cell] += w * share; });
    }
  });
  return sums;
}

template <int D>
void expect_uniform(const Grid<D>& grid, Walls<D>& walls) {
  walls.rebuild(grid);
  for (const int per_axis : {2, 3}) {
    const auto sums = uniform_filling(grid, walls, per_axis);
    for (int i = 0; i < grid.count(); ++i) {
      const bool free = grid.inside(grid.cell(i)) && !walls.blocked(i);
      EXPECT_NEAR(sums[i], free, 1e-13) << ::testing::PrintToString(grid.cell(i)) << ' ' << per_axis;
    }
  }
}

TEST(Folds, UniformFillingOfABoxIsUniform2D) {
  const Grid<2> grid({0, 0}, {6, 5}, 0.1);
  Walls<2> walls(grid);
  close_domain(grid, walls);
  expect_uniform(grid, walls);
}

TEST(Folds, UniformFillingOfABoxIsUniform3D) {
  const Grid<3> grid({0, 0, 0}, {4, 5, 3}, 0.1);
  Walls<3> walls(grid);
  close_domain(grid, walls);
  expect_uniform(grid, walls);
}

TEST(Folds, UniformFillingAroundABlockIsUniform) {  // four convex corners
  const Grid<2> grid({0, 0}, {8, 9}, 0.1);
  Walls<2> walls(grid);
  close_domain(grid, walls);
  add_block<2>(grid, walls, {3, 3}, {5, 6});
  expect_uniform(grid, walls);
}

TEST(Folds, UniformFillingOfAnLIsUniform) {  // convex next to concave corners
  const Grid<2> grid({0, 0}, {6, 6}, 0.1);
  Walls<2> walls(grid);
  close_domain(grid, walls);
  add_block<2>(grid, walls, {3, 3}, {6, 6});
  expect_uniform(grid, walls);
}

TEST(Folds, UniformFillingAlongAnEdgeInSpaceIsUniform) {
  const Grid<3> grid({0, 0, 0}, {5, 5, 4}, 0.1);
  Walls<3> walls(grid);
  close_domain(grid, walls);
  add_block<3>(grid, walls, {3, 3, 0}, {5, 5, 4});
  expect_uniform(grid, walls);
}

TEST(Folds, UniformFillingAroundACornerInSpaceIsUniform) {
  const Grid<3> grid({0, 0, 0}, {5, 5, 5}, 0.1);
  Walls<3> walls(grid);
  close_domain(grid, walls);
  add_block<3>(grid, walls, {2, 2, 2}, {5, 5, 5});
  expect_uniform(grid, walls);
}

TEST(Folds, UniformFillingBesideASheetPileIsUniform) {  // with a free tip
  const Grid<2> grid({0, 0}, {8, 6}, 0.1);
  Walls<2> walls(grid);
  close_domain(grid, walls);
  for (int y = 2; y < 6; ++y) walls.close(0, grid.index({4, y}), false);
  expect_uniform(grid, walls);
}

TEST(Folds, UniformFillingOfOneCellWideChannelsIsUniform) {
  const Grid<2> grid({0, 0}, {5, 5}, 0.1);
  Walls<2> walls(grid);
  close_domain(grid, walls);
  for (int y = 0; y < 5; ++y)
    walls.close(0, grid.index({2, y}), false), walls.close(0, grid.index({3, y}), false);
  expect_uniform(grid, walls);
  const Grid<2> narrow({0, 0}, {1, 7}, 0.1);
  Walls<2> sides(narrow);
  close_domain(narrow, sides);
  expect_uniform(narrow, sides);
}

/// Faces that a point at x reaches.
template <int D>
std::set<int> reached(const Grid<D>& grid, const Walls<D>& walls, const Vec<D>& x, int d) {
  std::set<int> faces;
  for_faces(grid, walls, PointKernel<D>(grid, x), d, [&](int face, double w, double, const Vec<D>&) {
    if (w > 0) faces.insert(face);
  });
  return faces;
}

/// Interpolated component d of the face field v at x.
template <int D, class V>
double value(const Grid<D>& grid, const Walls<D>& walls, const Vec<D>& x, int d, V&& v) {
  double sum = 0;
  for_faces(grid, walls, PointKernel<D>(grid, x), d,
            [&](int face, double w, double sign, const Vec<D>&) { sum += sign * w * v(face); });
  return sum;
}

const auto one = [](int) { return 1.0; };
/// Some field that vanishes on the given face row: y face `row` of a plane grid.
struct ZeroOnRow {
  const Grid<2>& grid;
  int d, row;
  double operator()(int face) const { return grid.cell(face)[d] == row ? 0 : 1 + std::sin(face); }
};

struct Floor : ::testing::Test {
  Grid<2> grid{{0, 0}, {6, 6}, 1};
  Walls<2> walls{grid};
  void close(bool no_slip) {
    for (int x = 0; x < 6; ++x) walls.close(1, grid.index({x, 0}), no_slip);
    walls.rebuild(grid);
  }
  void separate(bool value) {
    for (int x = 0; x < 6; ++x) walls.set_separated(1, grid.index({x, 0}), value);
  }
  void commit() {
    for (int x = 0; x < 6; ++x) walls.commit_separated(1, grid.index({x, 0}));
  }
};

TEST_F(Floor, NothingIsLeftBelowAndWeightsStillSumToOne) {
  close(false);
  for (int d = 0; d < 2; ++d) {
    double sum = 0;
    for_faces(grid, walls, PointKernel<2>(grid, {2.7, 0.2}), d,
              [&](int face, double w, double, const Vec<2>&) {
                EXPECT_GE(grid.cell(face)[1], 0);
                sum += w;
              });
    EXPECT_NEAR(sum, 1, 1e-15);
  }
}

TEST_F(Floor, NormalVelocityVanishesOnIt) {
  close(false);
  EXPECT_NEAR(value<2>(grid, walls, {2.7, 0.0}, 1, ZeroOnRow{grid, 1, 0}), 0, 1e-15);
  // The mirrored normal component is linear next to the wall: a point at η has weight η of the first face.
  const auto first_row = [&](int face) { return grid.cell(face)[1] == 1 ? 1.0 : 0.0; };
  EXPECT_NEAR(value<2>(grid, walls, {2.5, 0.2}, 1, first_row), 0.5 * (0.7 * 0.7 - 0.3 * 0.3), 1e-15);
}

TEST_F(Floor, SlipKeepsTheTangentialVelocity) {
  close(false);
  for (const double y : {0.0, 0.3, 0.9}) EXPECT_NEAR(value<2>(grid, walls, {2.7, y}, 0, one), 1, 1e-15);
}

TEST_F(Floor, NoSlipTurnsTheSignOfTheTangentialVelocity) {
  close(true);
  EXPECT_NEAR(value<2>(grid, walls, {2.7, 0.0}, 0, one), 0, 1e-15);
  // The row behind the wall has the weight ½(1 − η)² and counts twice with the minus sign.
  EXPECT_NEAR(value<2>(grid, walls, {2.7, 0.3}, 0, one), 1 - 2 * 0.5 * 0.7 * 0.7, 1e-15);
  EXPECT_NEAR(value<2>(grid, walls, {2.7, 1.0}, 0, one), 1, 1e-15);
}

TEST_F(Floor, SeparatedMatterKeepsTheSignOfItsNormalVelocity) {
  close(false);
  const Vec<2> x{2.5, 0.2};
  EXPECT_LT(value<2>(grid, walls, x, 1, one), 1 - 1e-3);
  separate(true);
  EXPECT_LT(value<2>(grid, walls, x, 1, one), 1 - 1e-3);  // one step folds with one sign
  commit();
  EXPECT_NEAR(value<2>(grid, walls, x, 1, one), 1, 1e-15);
  separate(false);
  commit();
  EXPECT_LT(value<2>(grid, walls, x, 1, one), 1 - 1e-3);
}

TEST_F(Floor, ClosedTwiceItIsRoughIfEitherIs) {
  walls.close(1, grid.index({2, 0}), true);
  walls.close(1, grid.index({2, 0}), false);
  EXPECT_TRUE(walls.no_slip(1, grid.index({2, 0})));
}

TEST(Folds, SideWallMirrorsTheOtherAxis) {
  const Grid<2> grid({0, 0}, {6, 6}, 1);
  Walls<2> walls(grid);
  for (int y = 0; y < 6; ++y) walls.close(0, grid.index({6, y}), true);
  walls.rebuild(grid);
  EXPECT_NEAR(value<2>(grid, walls, {6.0, 2.7}, 0, ZeroOnRow{grid, 0, 6}), 0, 1e-15);
  EXPECT_NEAR(value<2>(grid, walls, {6.0, 2.7}, 1, one), 0, 1e-15);
  for (int face : reached<2>(grid, walls, {5.9, 2.7}, 1)) EXPECT_LE(grid.cell(face)[0], 5);
}

TEST(Folds, NothingPassesAThinWallUnlessItIsOpened) {
  const Grid<2> grid({0, 0}, {6, 6}, 1);
  Walls<2> walls(grid);
  for (int y = 0; y < 6; ++y) walls.close(0, grid.index({3, y}), false);
  walls.rebuild(grid);
  const auto furthest = [&](const Vec<2>& x, int d, int side) {
    int most = side ? -9 : 9;
    for (int face : reached<2>(grid, walls, x, d))
      most = side ? std::max(most, grid.cell(face)[0]) : std::min(most, grid.cell(face)[0]);
    return most;
  };
  EXPECT_EQ(furthest({2.9, 2.4}, 0, 1), 3);  // the wall's own face
  EXPECT_EQ(furthest({2.9, 2.4}, 1, 1), 2);
  EXPECT_EQ(furthest({3.1, 2.4}, 0, 0), 3);
  EXPECT_EQ(furthest({3.1, 2.4}, 1, 0), 3);
  for_centers(grid, walls, PointKernel<2>(grid, {2.9, 2.4}),
              [&](int cell, double) { EXPECT_LE(grid.cell(cell)[0], 2); });

  for (int y = 0; y < 6; ++y) walls.open(0, grid.index({3, y}));
  walls.rebuild(grid);
  EXPECT_EQ(walls.folds(grid.index({2, 2})), nullptr);
  EXPECT_EQ(furthest({2.9, 2.4}, 0, 1), 4);
  EXPECT_EQ(furthest({3.1, 2.4}, 1, 0), 2);
}

TEST(Folds, InAConcaveCornerBothComponentsVanish) {
  const Grid<2> grid({0, 0}, {6, 6}, 1);
  Walls<2> walls(grid);
  close_domain(grid, walls);
  walls.rebuild(grid);
  for (int d = 0; d < 2; ++d) {
    EXPECT_NEAR(value<2>(grid, walls, {0, 0}, d, ZeroOnRow{grid, d, 0}), 0, 1e-15);
    for (int face : reached<2>(grid, walls, {0.1, 0.1}, d)) EXPECT_TRUE(grid.inside(grid.cell(face)));
  }
}

TEST(Folds, AChannelOneCellWideHoldsItsPoints) {
  const Grid<2> grid({0, 0}, {6, 6}, 1);
  Walls<2> walls(grid);
  for (int y = 0; y < 6; ++y)
    walls.close(0, grid.index({3, y}), true), walls.close(0, grid.index({4, y}), true);
  walls.rebuild(grid);
  for (const double x : {3.1, 3.5, 3.9}) {
    for (int face : reached<2>(grid, walls, {x, 2.4}, 0))
      EXPECT_TRUE(grid.cell(face)[0] == 3 || grid.cell(face)[0] == 4);
    for (int face : reached<2>(grid, walls, {x, 2.4}, 1)) EXPECT_EQ(grid.cell(face)[0], 3);
  }
  EXPECT_NEAR(value<2>(grid, walls, {3.0, 2.4}, 1, one), 0, 1e-15);
  EXPECT_NEAR(value<2>(grid, walls, {3.5, 2.4}, 1, one), 0.5, 1e-15);  // ¾ − 2·⅛
}

TEST(Folds, AroundAConvexCornerNothingReachesIntoTheBlock) {
  const Grid<2> grid({0, 0}, {8, 8}, 1);
  Walls<2> walls(grid);
  add_block<2>(grid, walls, {4, 4}, {8, 8});
  walls.rebuild(grid);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(2, 6);
  for (int i = 0; i < 500; ++i) {
    const Vec<2> x{place(random), place(random)};
    if (x[0] >= 4 && x[1] >= 4) continue;
    for_centers(grid, walls, PointKernel<2>(grid, x),
                [&](int cell, double) { EXPECT_FALSE(walls.blocked(cell)); });
    for (int d = 0; d < 2; ++d)
      for (int face : reached<2>(grid, walls, x, d))
        EXPECT_FALSE(walls.blocked(face) && walls.blocked(face - grid.stride[d]));
  }
}

}  // namespace
}  // namespace quicksand
