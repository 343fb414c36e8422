// Cells that hold too little water for a wet one: gaps between points, or air.

#include <gtest/gtest.h>

#include "engine/step/phases.hpp"
#include "tests/engine/step/motion.hpp"

namespace quicksand {
namespace {

using namespace test;

constexpr double kCell = 0.1;
constexpr int kAcross = 10, kUpTo = 8;  // cells of water along x and y

/// A tank of water at rest, with its pressure.
template <int D>
State<D> tank() {
  Scene scene = D == 2 ? plane(1, 1, kCell) : space({1, 1, 0.5}, kCell);
  add_body(scene, "water", BodyKind::water, {0, 0, 0}, {1, kUpTo * kCell, 0.5});
  return make_state<D>(scene);
}

template <int D>
int cell_at(const State<D>& s, int x, int y) {
  Cell<D> c{};
  c[0] = x, c[1] = y;
  if (D == 3) c[D - 1] = 2;
  return s.grid.index(c);
}

/// Takes from cells what they hold but for a part, as if points had left them.
template <int D>
void empty(State<D>& s, const std::vector<int>& cells, double part) {
  points_to_faces(s);
  for (const int cell : cells) s.cell_sums[cell].water = part * s.volume.cell(cell);
  find_surface(s);
}

template <typename T>
class Gaps : public testing::Test {};
template <int D>
struct Dimension {
  static constexpr int count = D;
};
using Dimensions = testing::Types<Dimension<2>, Dimension<3>>;
TYPED_TEST_SUITE(Gaps, Dimensions);

TYPED_TEST(Gaps, KeepPressureDeepInWater) {
  constexpr int D = TypeParam::count;
  State<D> s = tank<D>();
  const int gap = cell_at(s, 5, 3);
  const double before = s.pressure[gap];
  empty<D>(s, {gap}, 0.4);
  EXPECT_TRUE(s.cell[gap].wet());
  EXPECT_TRUE(s.cell[gap].is_gap());
  EXPECT_FALSE(s.cell[gap + 1].is_gap());
  EXPECT_EQ(s.pressure[gap], before);
  EXPECT_TRUE(s.cell[gap].confined);  // so that drift fills it
  EXPECT_NEAR(s.cell[gap].excess, -0.6, 1e-12);
}

TYPED_TEST(Gaps, OfAFewCellsBesideAWall) {
  constexpr int D = TypeParam::count;
  State<D> s = tank<D>();
  const std::vector<int> two{cell_at(s, 0, 2), cell_at(s, 0, 3)};
  empty<D>(s, two, 0.5);
  for (const int cell : two) EXPECT_TRUE(s.cell[cell].is_gap());
}

TYPED_TEST(Gaps, AreAirWhenEmptyOrLarge) {
  constexpr int D = TypeParam::count;
  State<D> s = tank<D>();
  const int hole = cell_at(s, 5, 3);
  empty<D>(s, {hole}, 0.05);
  EXPECT_FALSE(s.cell[hole].wet());
  EXPECT_EQ(s.pressure[hole], 0);
  std::vector<int> row;
  for (int x = 1; x < kAcross - 1; ++x) row.push_back(cell_at(s, x, 3));
  empty<D>(s, row, 0.5);
  for (const int cell : row) EXPECT_FALSE(s.cell[cell].wet());
}

TYPED_TEST(Gaps, AreAirWhereTheyReachTheSurface) {
  constexpr int D = TypeParam::count;
  State<D> s = tank<D>();
  const std::vector<int> down{cell_at(s, 5, kUpTo - 1), cell_at(s, 5, kUpTo - 2)};
  empty<D>(s, down, 0.5);
  for (const int cell : down) EXPECT_FALSE(s.cell[cell].wet());
}

/// Water that does not press may part: closed, they would pull at it. What was air is air.
TYPED_TEST(Gaps, AreAirWithoutPressure) {
  constexpr int D = TypeParam::count;
  State<D> s = tank<D>();
  const int gap = cell_at(s, 5, 3);
  s.pressure[gap] = 0;
  empty<D>(s, {gap}, 0.4);
  EXPECT_FALSE(s.cell[gap].wet());
}

/// A gap in a tank at rest fills within a few waves' time, without a blow.
TEST(Gap, FillsSlowly) {
  State<2> s = tank<2>();
  const int gap = cell_at(s, 5, 3);
  double highest = 0;
  const auto lift = [&](std::size_t p) {  // the points of the cell but one, to its neighbour
    return s.grid.index(s.grid.cell_of(s.water.x[p])) == gap && s.water.x[p][0] > 0.55;
  };
  for (std::size_t p = 0; p < s.water.size(); ++p)
    if (lift(p)) s.water.x[p][0] += kCell;
  points_to_faces(s);
  find_surface(s);
  const double fill = s.cell[gap].fill;
  const double rest = 1000 * 9.81 * 0.8;
  advance_times(s, 200, 2e-3, [&](const auto&) {
    for_each_cell(s.grid, [&](int i, const Cell<2>&) { highest = std::max(highest, s.pressure[i]); });
  });
  points_to_faces(s);
  find_surface(s);
  EXPECT_LT(fill, 0.8);
  EXPECT_GT(s.cell[gap].fill, 0.95);
  EXPECT_LT(highest, 1.5 * rest);
}

}  // namespace
}  // namespace quicksand
