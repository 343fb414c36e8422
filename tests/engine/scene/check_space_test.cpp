// The checks in space: extents, rectangles of faces, and bodies through layers of points.

#include "tests/engine/scene/basin.hpp"

namespace quicksand {
namespace {

using namespace test;

Region block(const Vec3& min, const Vec3& max) {
  Region r;
  r.min = min, r.max = max;
  return r;
}

/// The basin 0.5 m deep.
Scene tank() {
  Scene s = basin();
  s.domain.dimension = Dimension::space;
  s.domain.max[2] = 0.5;
  for (Body& body : s.bodies) body.region.max[2] = 0.5;
  return s;
}

Pointers after_in_space(const std::function<void(Scene&)>& change) {
  Scene scene = tank();
  change(scene);
  return faults_of(scene);
}

TEST(CheckSpace, ASoundSceneHasNoFault) { EXPECT_EQ(faults_of(tank()), Pointers{}); }

TEST(CheckSpace, TheThirdExtentCounts) {
  EXPECT_EQ(after_in_space([](Scene& s) { s.domain.max[2] = 0.45; }), Pointers{"/domain/max"});
  EXPECT_EQ(after_in_space([](Scene& s) { s.bodies[0].region.max[2] = 0.6; }), Pointers{"/bodies/0/region"});
  EXPECT_EQ(after_in_space([](Scene& s) { s.bodies[0].region.max[2] = 0; }),
            Pointers{"/bodies/0/region/box"});
  EXPECT_EQ(after_in_space([](Scene& s) {
              s.output.probes = {{"p", {0.5, 0.5, 0.25}, "head"}, {"q", {0.5, 0.5, 0.51}, "head"}};
            }),
            Pointers{"/output/probes/1/at"});
}

TEST(CheckSpace, OverlapsAreCountedThroughTheDepth) {
  Scene s = tank();
  // 2 × 2 points of the plane, 6 layers of 0.05 m from z = 0.1 to 0.4.
  s.bodies.push_back({"ball", BodyKind::water, "", block({0.2, 0.4, 0.1}, {0.3, 0.5, 0.4}), false, {}});
  const auto faults = check(s);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].pointer, "/bodies/2/region");
  EXPECT_NE(faults[0].detail.find("near (0.225, 0.425, 0.125) (24 points)"), std::string::npos)
      << faults[0].detail;
  s.bodies[2].region = block({0.2, 0.8, 0.1}, {0.3, 0.9, 0.4});
  EXPECT_EQ(faults_of(s), Pointers{});
}

TEST(CheckSpace, BodiesBesideEachOtherAlongTheDepthDoNotOverlap) {
  EXPECT_EQ(after_in_space([](Scene& s) {
              s.bodies[0].region.max[2] = 0.25;
              s.bodies[1].region = block({0, 0, 0.25}, {1, 0.3, 0.5});
            }),
            Pointers{});
}

TEST(CheckSpace, PolygonsAndDiscsGoThroughTheDepth) {
  Region polygon;
  polygon.kind = Region::Kind::polygon;
  polygon.vertices = {{0, 0.6}, {1, 0.6}, {0, 0.9}};
  EXPECT_EQ(after_in_space([&](Scene& s) {
              s.bodies.push_back({"wedge", BodyKind::water, "", polygon, false, {}});
            }),
            Pointers{});
  EXPECT_EQ(after_in_space([&](Scene& s) {
              s.bodies.push_back({"wedge", BodyKind::water, "", polygon, false, {}});
              s.walls.resize(1);
              s.walls[0].block = block({0, 0.6, 0.2}, {0.2, 0.7, 0.3});
            }),
            Pointers{"/bodies/2/region"});
}

TEST(CheckSpace, FixedBodiesFillWholeCellsAlongTheDepth) {
  const auto fixed = [](const Region& region) {
    return after_in_space([&](Scene& s) {
      s.bodies[0].fixed = true;
      s.bodies[0].region = region;
      s.bodies.pop_back();
    });
  };
  EXPECT_EQ(fixed(block({0, 0, 0.1}, {1, 0.3, 0.3})), Pointers{});
  EXPECT_EQ(fixed(block({0, 0, 0.1}, {1, 0.3, 0.35})), Pointers{"/bodies/0/region"});
  Region notch;
  notch.kind = Region::Kind::difference;
  notch.parts = {block({0, 0, 0}, {1, 0.3, 0.5}), block({0.5, 0.2, 0.1}, {0.6, 0.3, 0.25})};
  EXPECT_EQ(fixed(notch), Pointers{"/bodies/0/region"});
  notch.parts[1].max[2] = 0.3;
  EXPECT_EQ(fixed(notch), Pointers{});
  Region halves;  // two boxes that meet within a cell make it whole
  halves.kind = Region::Kind::union_of;
  halves.parts = {block({0, 0, 0}, {1, 0.3, 0.25}), block({0, 0, 0.25}, {1, 0.3, 0.5})};
  EXPECT_EQ(fixed(halves), Pointers{});
}

TEST(CheckSpace, WallsAreRectanglesOfFaces) {
  const auto wall = [](const Segment& line) {
    return after_in_space([&](Scene& s) {
      s.walls.resize(1);
      s.walls[0].line = line;
    });
  };
  EXPECT_EQ(wall({{0.5, 0, 0}, {0.5, 0.4, 0.5}}), Pointers{});
  EXPECT_EQ(wall({{0, 0.7, 0}, {0.4, 0.7, 0.5}}), Pointers{});
  EXPECT_EQ(wall({{0.5, 0, 0.2}, {0.5, 0.4, 0.2}}), Pointers{"/walls/0/line"});  // an edge
  EXPECT_EQ(wall({{0.5, 0, 0}, {0.6, 0.4, 0.5}}), Pointers{"/walls/0/line"});    // a box
  EXPECT_EQ(wall({{0, 0, 0}, {0, 0.4, 0.5}}), Pointers{"/walls/0/line"});        // on the domain's side
  EXPECT_EQ(wall({{0.5, 0, 0}, {0.5, 0.4, 0.45}}), Pointers{"/walls/0/line/to"});
}

TEST(CheckSpace, GatesMayNotLieOnWalls) {
  const auto gate = [](const Segment& line) {
    return after_in_space([&](Scene& s) {
      s.walls.resize(1);
      s.walls[0].line = Segment{{0.5, 0, 0}, {0.5, 0.4, 0.2}};
      s.gates = {{"gate", line}};
      s.stages.push_back(s.stages[0]);
      s.stages[1].name = "open";
      s.stages[1].open_gates = {"gate"};
    });
  };
  EXPECT_EQ(gate({{0.5, 0, 0.2}, {0.5, 0.4, 0.5}}), Pointers{});
  EXPECT_EQ(gate({{0.5, 0.3, 0.1}, {0.5, 0.4, 0.5}}), Pointers{"/gates/0/line"});
}

TEST(CheckSides, FrontAndBackAreSidesInSpaceOnly) {
  EXPECT_EQ(after([](Scene& s) {
              Load load;
              load.name = "push", load.body = "sand", load.side = BodySide::back, load.traction = {0, 0, 1};
              s.loads = {load};
            }),
            Pointers{"/loads/0/side"});
}

TEST(CheckAxis, TheRadiusIsNotNegative) {
  EXPECT_EQ(after([](Scene& s) {
              s.domain.dimension = Dimension::axisymmetric;
              s.domain.min[0] = -1;
            }),
            Pointers{"/domain/min"});
}

}  // namespace
}  // namespace quicksand
