#include "engine/scene/region.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace quicksand {
namespace {

Region box(double x0, double y0, double x1, double y1) {
  Region r;
  r.min = {x0, y0, 0}, r.max = {x1, y1, 1};
  return r;
}
Region polygon(std::vector<std::array<double, 2>> vertices) {
  Region r;
  r.kind = Region::Kind::polygon;
  r.vertices = std::move(vertices);
  return r;
}
Region disc(double x, double y, double radius) {
  Region r;
  r.kind = Region::Kind::disc;
  r.center = {x, y, 0}, r.radius = radius;
  return r;
}
Region combined(Region::Kind kind, std::vector<Region> parts) {
  Region r;
  r.kind = kind;
  r.parts = std::move(parts);
  return r;
}
const Region frame = combined(Region::Kind::difference, {box(0, 0, 4, 4), box(1, 1, 3, 3), disc(4, 4, 0.5)});
const Region pair = combined(Region::Kind::union_of, {box(0, 0, 2, 2), disc(2, 1, 1)});
const Region star = polygon({{0, 0}, {4, 0}, {4, 3}, {2, 1}, {0, 3}});

TEST(Region, IsClosedBelowAndOpenAbove) {
  const Region r = box(0, 0, 1, 1);
  EXPECT_TRUE(contains(r, {0, 0, 0}));
  EXPECT_FALSE(contains(r, {1, 0.5, 0}));
  EXPECT_FALSE(contains(r, {0.5, 1, 0}));
  EXPECT_TRUE(contains(r, {0.5, 0.5, 7}));      // the third coordinate does not count in the plane
  EXPECT_FALSE(contains(r, {0.5, 0.5, 7}, 3));  // but in space
}

TEST(Region, NeighboursShareNoPoint) {
  // Two triangles with a common slanted edge, given in opposite directions.
  const Region a = polygon({{0, 0}, {0.7, 0}, {0.3, 1.1}}), b = polygon({{0.3, 1.1}, {0.7, 0}, {1, 1.1}});
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 110; ++j) {
      const Vec3 p{i * 0.01, j * 0.01, 0};
      EXPECT_FALSE(contains(a, p) && contains(b, p)) << p[0] << " " << p[1];
    }
  EXPECT_TRUE(contains(a, {0.5, 0.55, 0}) || contains(b, {0.5, 0.55, 0}));  // the middle of the edge
}

TEST(Region, OrientationOfPolygonsDoesNotMatter) {
  Region turned = star;
  std::reverse(turned.vertices.begin(), turned.vertices.end());
  for (double x = -0.5; x < 5; x += 0.13)
    for (double y = -0.5; y < 4; y += 0.13) EXPECT_EQ(contains(star, {x, y, 0}), contains(turned, {x, y, 0}));
  EXPECT_TRUE(contains(star, {0.2, 2, 0}));
  EXPECT_FALSE(contains(star, {2, 2, 0}));  // in the notch
}

TEST(Region, UnionAndDifference) {
  EXPECT_TRUE(contains(pair, {2.9, 1, 0}));
  EXPECT_TRUE(contains(pair, {0.1, 1.9, 0}));
  EXPECT_FALSE(contains(pair, {2.9, 1.9, 0}));
  EXPECT_TRUE(contains(frame, {0.5, 0.5, 0}));
  EXPECT_FALSE(contains(frame, {2, 2, 0}));
  EXPECT_FALSE(contains(frame, {3.9, 3.9, 0}));
}

TEST(Region, StretchesAgreeWithContains) {
  for (const Region& r : {box(0.3, 0.2, 2, 3), star, disc(2, 2, 1.5), pair, frame,
                          combined(Region::Kind::union_of, {frame, star})})
    for (double y = -0.5; y < 4.5; y += 0.097) {
      const Stretches along_x = stretches(r, 0, y), along_y = stretches(r, 1, y);
      for (double x = -0.5; x < 4.5; x += 0.0931) {
        const auto in = [x](const Stretches& all) {
          return std::any_of(all.begin(), all.end(), [x](const auto& s) { return s[0] <= x && x < s[1]; });
        };
        ASSERT_EQ(in(along_x), contains(r, {x, y, 0})) << x << " " << y;
        ASSERT_EQ(in(along_y), contains(r, {y, x, 0})) << y << " " << x;
      }
      for (std::size_t k = 1; k < along_x.size(); ++k) EXPECT_LT(along_x[k - 1][1], along_x[k][0]);
    }
}

TEST(Region, BoundingBoxes) {
  EXPECT_EQ(bounding_box(star).max, (Vec3{4, 3, 0}));
  EXPECT_EQ(bounding_box(disc(1, 2, 0.5)).min, (Vec3{0.5, 1.5, 0}));
  EXPECT_EQ(bounding_box(pair).max[0], 3);
  EXPECT_EQ(bounding_box(frame).max[0], 4);
  EXPECT_TRUE(bounding_box(polygon({})).empty);
}

TEST(Region, AreaConvergesToTheExactOne) {
  EXPECT_NEAR(area(box(0, 0, 0.3, 0.2), 0.05), 0.06, 1e-14);
  EXPECT_NEAR(area(star, 0.01), 8, 1e-3);  // 12 less the notch 4·2/2
  EXPECT_NEAR(area(disc(1, 1, 2), 0.01), 4 * std::numbers::pi, 1e-2);
  EXPECT_NEAR(area(pair, 0.001), 4 + std::numbers::pi / 2, 1e-3);
  EXPECT_EQ(area(polygon({}), 0.1), 0);
}

TEST(Region, CrossingPolygons) {
  EXPECT_FALSE(crosses_itself(star.vertices));
  EXPECT_FALSE(crosses_itself({{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_TRUE(crosses_itself({{0, 0}, {1, 1}, {1, 0}, {0, 1}}));
  EXPECT_TRUE(crosses_itself({{0, 0}, {1, 0}, {1, 0}, {0, 1}}));  // a corner given twice
}

}  // namespace
}  // namespace quicksand
