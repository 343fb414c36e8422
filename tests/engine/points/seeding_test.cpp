#include "engine/points/seeding.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "engine/grid/scene_grid.hpp"
#include "engine/grid/walls.hpp"
#include "engine/scene/region.hpp"
#include "tests/engine/small_scene.hpp"

namespace quicksand {
namespace {

using test::add_body;

double total(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

TEST(Seeding, SaturatedSoilHasBothPhasesAtEachPlace) {
  Scene s = test::plane(1, 1, 0.1);
  add_body(s, "bed", BodyKind::saturated_soil, {0.2, 0, 0}, {0.7, 0.3, 0});
  const auto points = seed<2>(s, make_grid<2>(s));
  ASSERT_EQ(points.soil.size(), 5u * 3 * 4);
  ASSERT_EQ(points.water.size(), points.soil.size());
  EXPECT_EQ(points.fixed.size(), 0u);
  EXPECT_EQ(points.soil.x, points.water.x);
  EXPECT_EQ(points.soil.start, points.soil.x);
  EXPECT_NEAR(total(points.soil.mass), 0.6 * 2650 * 0.15, 1e-9);
  EXPECT_NEAR(total(points.water.mass), 0.4 * 1000 * 0.15, 1e-9);
  for (double n : points.soil.porosity) EXPECT_EQ(n, 0.4);
}

TEST(Seeding, DrySoilHasNoWaterAndWaterNoSoil) {
  Scene s = test::plane(1, 1, 0.1);
  add_body(s, "dry", BodyKind::soil, {0, 0, 0}, {0.5, 0.5, 0});
  add_body(s, "pool", BodyKind::water, {0.5, 0, 0}, {1, 0.2, 0});
  s.numerics.points_per_cell = 3;
  const auto points = seed<2>(s, make_grid<2>(s));
  EXPECT_EQ(points.soil.size(), 25u * 9);
  EXPECT_EQ(points.water.size(), 10u * 9);
  EXPECT_NEAR(total(points.soil.mass), 0.6 * 2650 * 0.25, 1e-9);
  EXPECT_NEAR(total(points.water.mass), 1000 * 0.1, 1e-9);
  for (const auto b : points.soil.body) EXPECT_EQ(b, 0);
  for (const auto b : points.water.body) EXPECT_EQ(b, 1);
}

TEST(Seeding, FixedSoilIsKeptApartAndStill) {
  Scene s = test::plane(1, 1, 0.1);
  add_body(s, "filter", BodyKind::saturated_soil, {0, 0, 0}, {1, 0.2, 0});
  s.bodies.back().fixed = true;
  s.bodies.back().velocity = {1, 2, 0};
  const auto points = seed<2>(s, make_grid<2>(s));
  EXPECT_EQ(points.soil.size(), 0u);
  EXPECT_EQ(points.fixed.size(), 20u * 4);
  EXPECT_EQ(points.water.size(), 20u * 4);
  for (const auto& v : points.fixed.v) EXPECT_EQ(v, (Vec<2>{0, 0}));
  for (const auto& v : points.water.v) EXPECT_EQ(v, (Vec<2>{1, 2}));
}

TEST(Seeding, PlacesAreEvenWithinCells) {
  Scene s = test::plane(0.4, 0.4, 0.2);
  add_body(s, "pool", BodyKind::water, {0, 0, 0}, {0.2, 0.2, 0});
  const auto points = seed<2>(s, make_grid<2>(s));
  const std::vector<Vec<2>> expected{{0.05, 0.05}, {0.15, 0.05}, {0.05, 0.15}, {0.15, 0.15}};
  ASSERT_EQ(points.water.size(), 4u);
  for (int p = 0; p < 4; ++p)
    for (int d = 0; d < 2; ++d) EXPECT_NEAR(points.water.x[p][d], expected[p][d], 1e-15);
}

TEST(Seeding, MassesInSpace) {
  Scene s = test::space({0.4, 0.3, 0.5}, 0.1);
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.4, 0.3, 0.2});
  add_body(s, "pool", BodyKind::water, {0, 0, 0.2}, {0.4, 0.3, 0.4});
  const auto points = seed<3>(s, make_grid<3>(s));
  EXPECT_EQ(points.soil.size(), 4u * 3 * 2 * 8);
  EXPECT_EQ(points.water.size(), 4u * 3 * 4 * 8);
  EXPECT_NEAR(total(points.soil.mass), 0.6 * 2650 * 0.024, 1e-9);
  EXPECT_NEAR(total(points.water.mass), 0.4 * 1000 * 0.024 + 1000 * 0.024, 1e-9);
}

TEST(Seeding, EachPointKnowsItsMaterial) {
  Scene s = test::plane(1, 1, 0.1);
  add_body(s, "upper", BodyKind::soil, {0, 0.5, 0}, {1, 1, 0});
  add_body(s, "lower", BodyKind::soil, {0, 0, 0}, {1, 0.5, 0});
  Soil gravel = test::sand();
  gravel.porosity = 0.3;
  s.soils["gravel"] = gravel;  // before "sand" in Scene::soils
  s.bodies[1].soil = "gravel";
  const auto points = seed<2>(s, make_grid<2>(s));
  for (std::size_t p = 0; p < points.soil.size(); ++p) {
    const bool low = points.soil.x[p][1] < 0.5;
    EXPECT_EQ(points.soil.soil[p], low ? 0 : 1);
    EXPECT_EQ(points.soil.porosity[p], low ? 0.3 : 0.4);
    EXPECT_EQ(points.soil.body[p], low ? 1 : 0);
  }
}

/// The bodies by brute force: what `contains` says place by place.
template <int D>
std::vector<std::pair<Vec<D>, int>> place_by_place(const Scene& s, const Grid<D>& grid) {
  std::vector<std::pair<Vec<D>, int>> all;
  const int n = s.numerics.points_per_cell;
  for_each_cell(grid, [&](int, const Cell<D>& c) {
    for (int k = 0; k < power(n, D); ++k) {
      Vec3 x{};
      for (int d = 0, rest = k; d < D; ++d, rest /= n)
        x[d] = grid.origin[d] + (c[d] + (rest % n + 0.5) / n) * grid.h;
      for (std::size_t b = 0; b < s.bodies.size(); ++b) {
        if (!contains(s.bodies[b].region, x, D)) continue;
        Vec<D> at;
        std::copy_n(x.begin(), D, at.begin());
        all.emplace_back(at, static_cast<int>(b));
        break;
      }
    }
  });
  return all;
}

Region part(Region::Kind kind, std::vector<Region> parts) {
  Region r;
  r.kind = kind;
  r.parts = std::move(parts);
  return r;
}

/// Shapes that touch, leave holes and lie beside each other.
Scene shapes(Scene s) {
  Region wedge, disc;
  wedge.kind = Region::Kind::polygon;
  wedge.vertices = {{0.1, 0.1}, {0.83, 0.17}, {0.71, 0.66}, {0.4, 0.35}, {0.2, 0.9}};
  disc.kind = Region::Kind::disc;
  disc.center = {0.55, 0.3, 0}, disc.radius = 0.17;
  const Region hole = test::box({0.2, 0.2, 0.11}, {0.3, 0.3, 0.33});
  add_body(s, "wedge", BodyKind::water, {}, {});
  s.bodies[0].region = part(Region::Kind::difference, {wedge, disc, hole});
  add_body(s, "disc", BodyKind::water, {}, {});
  s.bodies[1].region = part(Region::Kind::union_of, {disc, hole});
  add_body(s, "box", BodyKind::water, {0.15, 0.15, 0.2}, {0.95, 0.8, 0.4});  // what the others leave
  return s;
}

TEST(Seeding, RowsOfPlacesAreWhatRegionsHoldPlaceByPlace) {
  for (const int per_cell : {1, 2, 3}) {
    Scene plane = shapes(test::plane(1, 1, 0.05));
    plane.numerics.points_per_cell = per_cell;
    const Grid<2> grid = make_grid<2>(plane);
    const auto points = seed<2>(plane, grid).water;
    const auto expected = place_by_place(plane, grid);
    ASSERT_EQ(points.size(), expected.size());
    for (std::size_t p = 0; p < points.size(); ++p)
      ASSERT_EQ(std::pair(points.x[p], static_cast<int>(points.body[p])), expected[p]);
  }
  Scene space = shapes(test::space({1, 1, 0.4}, 0.1));
  const Grid<3> grid = make_grid<3>(space);
  const auto points = seed<3>(space, grid).water;
  const auto expected = place_by_place(space, grid);
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t p = 0; p < points.size(); ++p)
    ASSERT_EQ(std::pair(points.x[p], static_cast<int>(points.body[p])), expected[p]);
}

}  // namespace
}  // namespace quicksand
