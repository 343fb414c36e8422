#include "engine/grid/scene_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/engine/small_scene.hpp"

namespace quicksand {
namespace {

using test::add_body;
using test::box;

template <int D>
int closed_count(const Grid<D>& grid, const Walls<D>& walls, int d) {
  int n = 0;
  for (int i = 0; i < grid.count(); ++i) n += walls.closed(d, i);
  return n;
}

TEST(MakeGrid, RoundsTheDomainToCells) {
  Scene s = test::plane(0.7, 0.3, 0.1);
  s.domain.min = {-0.2, 0.1, 0};
  const Grid<2> grid = make_grid<2>(s);
  EXPECT_EQ(grid.cells, (Cell<2>{9, 2}));
  EXPECT_EQ(grid.origin, (Vec<2>{-0.2, 0.1}));
  s.numerics.cell_size_factor = 0.5;
  EXPECT_EQ(make_grid<2>(s).cells, (Cell<2>{18, 4}));
  EXPECT_EQ((make_grid<3>(test::space({0.3, 0.2, 0.4}, 0.1)).cells), (Cell<3>{3, 2, 4}));
}

TEST(FacesOn, UprightAndLevelLines) {
  const Grid<2> grid({0, 0}, {10, 8}, 0.1);
  const auto upright = faces_on(grid, {{0.3, 0.2, 0}, {0.3, 0.5, 0}});
  ASSERT_EQ(upright.size(), 3u);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(upright[k], (std::pair{0, grid.index({3, 2 + k})}));
  const auto level = faces_on(grid, {{0.9, 0.4, 0}, {0.7, 0.4, 0}});  // either direction
  ASSERT_EQ(level.size(), 2u);
  for (int k = 0; k < 2; ++k) EXPECT_EQ(level[k], (std::pair{1, grid.index({7 + k, 4})}));
}

TEST(FacesOn, TheDomainsOwnSidesAndClipping) {
  const Grid<2> grid({0, 0}, {10, 8}, 0.1);
  const auto right = faces_on(grid, {{1.0, 0, 0}, {1.0, 5, 0}});
  ASSERT_EQ(right.size(), 8u);
  EXPECT_EQ(right.front(), (std::pair{0, grid.index({10, 0})}));
  EXPECT_TRUE(faces_on(grid, {{1.2, 0, 0}, {1.2, 0.5, 0}}).empty());
  EXPECT_TRUE(faces_on(grid, {{0.1, 0.1, 0}, {0.3, 0.4, 0}}).empty());  // on no axis
}

TEST(FacesOn, RectanglesInSpace) {
  const Grid<3> grid({0, 0, 0}, {4, 5, 6}, 0.1);
  const auto faces = faces_on(grid, {{0.1, 0.2, 0.1}, {0.3, 0.2, 0.5}});
  ASSERT_EQ(faces.size(), 2u * 4);
  for (const auto& [d, face] : faces) {
    EXPECT_EQ(d, 1);
    const Cell<3> c = grid.cell(face);
    EXPECT_EQ(c[1], 2);
    EXPECT_TRUE(c[0] >= 1 && c[0] < 3 && c[2] >= 1 && c[2] < 5);
  }
}

TEST(MakeWalls, TheDomainIsClosedAllAround) {
  Scene s = test::plane(0.6, 0.4, 0.1);
  s.domain.sides[2].kind = SideKind::no_slip;  // bottom
  const Grid<2> grid = make_grid<2>(s);
  const auto walls = make_walls(s, grid, {});
  EXPECT_EQ(closed_count(grid, walls.water, 0), 2 * 4);
  EXPECT_EQ(closed_count(grid, walls.water, 1), 2 * 6);
  for (int x = 0; x < 6; ++x) {
    EXPECT_TRUE(walls.water.no_slip(1, grid.index({x, 0})));
    EXPECT_FALSE(walls.water.no_slip(1, grid.index({x, 4})));
    EXPECT_TRUE(walls.water.closed(1, grid.index({x, 4})));
  }
  EXPECT_TRUE(walls.water.blocked(grid.index({-1, 0})));
  EXPECT_FALSE(walls.water.blocked(grid.index({0, 0})));
  EXPECT_NE(walls.water.folds(grid.index({0, 2})), nullptr);  // folds are ready to use
  EXPECT_EQ(walls.water.folds(grid.index({2, 2})), nullptr);
}

TEST(MakeWalls, TheDomainIsClosedAllAroundInSpace) {
  const Scene s = test::space({0.3, 0.4, 0.5}, 0.1);
  const Grid<3> grid = make_grid<3>(s);
  const auto walls = make_walls(s, grid, {});
  EXPECT_EQ(closed_count(grid, walls.soil, 0), 2 * 4 * 5);
  EXPECT_EQ(closed_count(grid, walls.soil, 1), 2 * 3 * 5);
  EXPECT_EQ(closed_count(grid, walls.soil, 2), 2 * 3 * 4);
}

TEST(MakeWalls, BlocksAreClosedOnTheirOutlineOnly) {
  Scene s = test::plane(1, 1, 0.1);
  s.walls = {{"pier", box({0.3, 0.4, 0}, {0.6, 0.6, 0}), {}, true}};
  const Grid<2> grid = make_grid<2>(s);
  const auto walls = make_walls(s, grid, {});
  EXPECT_EQ(closed_count(grid, walls.water, 0), 20 + 2 * 2);
  EXPECT_EQ(closed_count(grid, walls.water, 1), 20 + 2 * 3);
  EXPECT_TRUE(walls.water.no_slip(0, grid.index({3, 4})));
  EXPECT_TRUE(walls.water.no_slip(0, grid.index({6, 5})));
  EXPECT_TRUE(walls.water.closed(1, grid.index({4, 6})));
  EXPECT_FALSE(walls.water.closed(0, grid.index({4, 4})));  // within
  int blocked = 0;
  for_each_cell(grid,
                [&](int i, const Cell<2>&) { blocked += walls.water.blocked(i) && walls.soil.blocked(i); });
  EXPECT_EQ(blocked, 6);
}

TEST(MakeWalls, LinesCloseWithoutBlocking) {
  Scene s = test::plane(1, 1, 0.1);
  s.walls = {{"pile", {}, Segment{{0.5, 0.4, 0}, {0.5, 1, 0}}, false}};
  const Grid<2> grid = make_grid<2>(s);
  const auto walls = make_walls(s, grid, {});
  EXPECT_EQ(closed_count(grid, walls.soil, 0), 20 + 6);
  EXPECT_TRUE(walls.soil.closed(0, grid.index({5, 4})));
  EXPECT_FALSE(walls.soil.closed(0, grid.index({5, 3})));
  for_each_cell(grid, [&](int i, const Cell<2>&) { EXPECT_FALSE(walls.soil.blocked(i)); });
}

TEST(MakeWalls, GatesAreClosedUnlessNamed) {
  Scene s = test::plane(1, 1, 0.1);
  s.gates = {{"left", {{0.3, 0, 0}, {0.3, 1, 0}}}, {"right", {{0.7, 0, 0}, {0.7, 1, 0}}}};
  const Grid<2> grid = make_grid<2>(s);
  EXPECT_EQ(closed_count(grid, make_walls(s, grid, {}).water, 0), 20 + 20);
  const auto walls = make_walls(s, grid, {"right"});
  EXPECT_EQ(closed_count(grid, walls.water, 0), 20 + 10);
  EXPECT_TRUE(walls.water.closed(0, grid.index({3, 0})));
  EXPECT_FALSE(walls.water.closed(0, grid.index({7, 0})));
  EXPECT_EQ(closed_count(grid, make_walls(s, grid, {"left", "right"}).soil, 0), 20);
}

template <int D>
void expect_fixed_body_stops_grains_only(Scene s, const Cell<D>& inside, int outline) {
  s.bodies.back().fixed = true;
  const Grid<D> grid = make_grid<D>(s);
  const auto walls = make_walls(s, grid, {});
  int more = 0;
  for (int d = 0; d < D; ++d) more += closed_count(grid, walls.soil, d) - closed_count(grid, walls.water, d);
  EXPECT_EQ(more, outline);
  EXPECT_TRUE(walls.soil.blocked(grid.index(inside)));
  EXPECT_FALSE(walls.water.blocked(grid.index(inside)));
}

TEST(MakeWalls, FixedBodiesStopGrainsButNotWater) {
  Scene s = test::plane(1, 1, 0.1);
  add_body(s, "filter", BodyKind::saturated_soil, {0.2, 0.3, 0}, {0.6, 0.5, 0});
  expect_fixed_body_stops_grains_only<2>(s, {3, 4}, 2 * (4 + 2));
  Scene t = test::space({0.5, 0.5, 0.5}, 0.1);
  add_body(t, "filter", BodyKind::saturated_soil, {0.1, 0.1, 0.1}, {0.3, 0.4, 0.2});
  expect_fixed_body_stops_grains_only<3>(t, {1, 2, 1}, 2 * (2 * 3 + 2 * 1 + 3 * 1));
}

TEST(MakeWalls, RemovedBodiesStopNothing) {
  Scene s = test::plane(1, 1, 0.1);
  add_body(s, "filter", BodyKind::saturated_soil, {0.2, 0.3, 0}, {0.6, 0.5, 0});
  add_body(s, "plate", BodyKind::soil, {0.2, 0.7, 0}, {0.6, 0.8, 0});
  for (Body& body : s.bodies) body.fixed = true;
  const Grid<2> grid = make_grid<2>(s);
  const auto walls = make_walls(s, grid, {}, {1, 0});
  EXPECT_FALSE(walls.soil.blocked(grid.index({3, 4})));
  EXPECT_TRUE(walls.soil.blocked(grid.index({3, 7})));
  EXPECT_EQ(closed_count(grid, walls.soil, 1), 20 + 8);
}

}  // namespace
}  // namespace quicksand
