// Reservoirs, plates and probes: where they may be.

#include "tests/engine/scene/basin.hpp"

namespace quicksand {
namespace {

using namespace test;

TEST(CheckWall, HiddenOnesAreIdle) {
  const auto beside_block = [](const std::function<void(Wall&)>& change) {
    return after([&](Scene& s) {
      s.walls.resize(2);
      s.walls[0].name = "block", s.walls[0].block = box(0.4, 0.6, 0.8, 1);
      s.walls[1].name = "other";
      change(s.walls[1]);
    });
  };
  const auto line = [](double x, double y0, double y1, bool no_slip) {
    return [=](Wall& w) { w.line = Segment{{x, y0, 0}, {x, y1, 0}}, w.no_slip = no_slip; };
  };
  EXPECT_EQ(beside_block(line(0.3, 0.6, 0.8, false)), Pointers{});
  EXPECT_EQ(beside_block(line(0.4, 0.6, 0.8, false)), Pointers{"/walls/1/line"});
  EXPECT_EQ(beside_block(line(0.4, 0.6, 0.8, true)), Pointers{});  // makes the face rough
  EXPECT_EQ(beside_block(line(0.6, 0.6, 0.8, true)), Pointers{"/walls/1/line"});
  EXPECT_EQ(beside_block(line(0.4, 0.4, 0.8, false)), Pointers{});  // goes on below the block
  EXPECT_EQ(beside_block([](Wall& w) { w.block = box(0.5, 0.7, 0.7, 1); }), Pointers{"/walls/1/block"});
  EXPECT_EQ(beside_block([](Wall& w) { w.block = box(0.4, 0.6, 0.8, 1); }), Pointers{"/walls/1/block"});
  EXPECT_EQ(beside_block([](Wall& w) { w.block = box(0.5, 0.7, 0.9, 1); }), Pointers{});
}

Pointers with_reservoir(const Segment& line, const std::function<void(Scene&)>& more = {}) {
  return after([&](Scene& s) {
    s.walls.resize(1);
    s.walls[0].block = box(0.6, 0.6, 0.8, 1);
    s.reservoirs = {{"lake", line, 0.8}};
    if (more) more(s);
  });
}

TEST(CheckReservoir, LiesOnTheEdgeOrOnABlock) {
  EXPECT_EQ(with_reservoir({{0, 0.3, 0}, {0, 0.6, 0}}), Pointers{});
  EXPECT_EQ(with_reservoir({{0.6, 0.7, 0}, {0.6, 0.9, 0}}), Pointers{});
  EXPECT_EQ(with_reservoir({{0.6, 0.6, 0}, {0.8, 0.6, 0}}), Pointers{});
  EXPECT_EQ(with_reservoir({{0.5, 0.7, 0}, {0.5, 0.9, 0}}), Pointers{"/reservoirs/0/line"});  // in the open
  EXPECT_EQ(with_reservoir({{0.7, 0.7, 0}, {0.7, 0.9, 0}}), Pointers{"/reservoirs/0/line"});  // in the block
  EXPECT_EQ(with_reservoir({{0.6, 0.5, 0}, {0.6, 0.9, 0}}), Pointers{"/reservoirs/0/line"});  // past its end
  EXPECT_EQ(with_reservoir({{0.5, 1, 0}, {0.7, 1, 0}}), Pointers{"/reservoirs/0/line"});      // half covered
}

TEST(CheckReservoir, HasOneLevelInEachPlaceAndNeedsWeight) {
  EXPECT_EQ(with_reservoir({{0, 0.3, 0}, {0, 0.6, 0}},
                           [](Scene& s) {
                             s.reservoirs.push_back({"sea", {{0, 0.5, 0}, {0, 0.8, 0}}, 0.7});
                           }),
            Pointers{"/reservoirs/1/line"});
  EXPECT_EQ(with_reservoir({{0, 0.3, 0}, {0, 0.6, 0}},
                           [](Scene& s) {
                             s.gravity = {0, 0, 0};
                           }),
            Pointers{"/reservoirs/0/head"});
}

TEST(CheckReservoir, TheAxisIsNoBoundary) {
  EXPECT_EQ(
      after([](Scene& s) {
        s.domain.dimension = Dimension::axisymmetric;
        s.reservoirs = {{"well", {{0, 0, 0}, {0, 0.4, 0}}, 0.8}, {"rim", {{1, 0, 0}, {1, 0.4, 0}}, 0.8}};
        s.output.sections = {{"axis", {{0, 0, 0}, {0, 0.4, 0}}, "flow"}};
      }),
      (Pointers{"/output/sections/0/line", "/reservoirs/0/line"}));
}

TEST(CheckReservoir, BringsWaterToADryScene) {
  const auto dry = [](const std::function<void(Scene&)>& change) {
    return after([&](Scene& s) {
      s.bodies.pop_back();
      s.bodies[0].kind = BodyKind::soil;
      s.output.probes = {{"p", {0.5, 0.1, 0}, "head"}};
      s.output.sections = {{"cut", {{0.5, 0, 0}, {0.5, 1, 0}}, "flow"}};
      change(s);
    });
  };
  EXPECT_EQ(dry([](Scene&) {}), (Pointers{"/output/probes/0/quantity", "/output/sections/0/quantity"}));
  EXPECT_EQ(dry([](Scene& s) { s.reservoirs = {{"lake", {{0, 0, 0}, {0, 0.6, 0}}, 0.5}}; }), Pointers{});
}

Load plate_on_sand(double x0, double x1, double y = 0.3) {
  Load load;
  load.kind = Load::Kind::plate;
  load.name = "plate";
  load.body = "sand";
  load.plate = {{x0, y, 0}, {x1, y, 0}};
  load.plate_velocity = {0, -0.01, 0};
  return load;
}

Pointers with_plates(const std::vector<Load>& loads) {
  return after([&](Scene& s) { s.loads = loads; });
}

TEST(CheckPlate, LiesOnTopOfItsBody) {
  EXPECT_EQ(with_plates({plate_on_sand(0.2, 0.6)}), Pointers{});
  EXPECT_EQ(with_plates({plate_on_sand(0.2, 0.6, 0.2)}), Pointers{"/loads/0/plate"});  // within it
  EXPECT_EQ(with_plates({plate_on_sand(0.2, 0.6, 0.4)}), Pointers{"/loads/0/plate"});  // above it
  Load upright = plate_on_sand(0.2, 0.2);
  upright.plate.to[1] = 0.5;
  EXPECT_EQ(with_plates({upright}), Pointers{"/loads/0/plate"});
  EXPECT_EQ(after([](Scene& s) {
              s.bodies[0].region.max[0] = 0.5;
              s.loads = {plate_on_sand(0.2, 0.6)};
            }),
            Pointers{"/loads/0/plate"});  // past its end
}

TEST(CheckPlate, PressesDownAndTakesAlongOnlyIfRough) {
  const auto plate = [](const std::function<void(Load&)>& change,
                        Dimension dimension = Dimension::plane_strain) {
    return after([&](Scene& s) {
      s.domain.dimension = dimension;
      s.loads = {plate_on_sand(0.2, 0.6)};
      change(s.loads[0]);
    });
  };
  EXPECT_EQ(plate([](Load& l) { l.plate_force = {0, -10, 0}; }), Pointers{});
  EXPECT_EQ(plate([](Load& l) { l.plate_force = {0, 10, 0}; }), Pointers{"/loads/0/plate_force"});
  EXPECT_EQ(plate([](Load& l) { l.plate_force = {1, -10, 0}; }), Pointers{"/loads/0/plate_force"});
  const auto sliding = [](bool rough) {
    return [rough](Load& l) { l.plate_velocity = {0.1, -0.01, 0}, l.rough = rough; };
  };
  EXPECT_EQ(plate(sliding(true)), Pointers{});
  EXPECT_EQ(plate(sliding(false)), Pointers{"/loads/0/plate_velocity"});
  EXPECT_EQ(plate(sliding(true), Dimension::axisymmetric), Pointers{"/loads/0/plate_velocity"});
}

TEST(CheckPlate, TwoMayShareAPlaceButNotAtATime) {
  Load second = plate_on_sand(0.4, 0.8);
  second.name = "second";
  EXPECT_EQ(with_plates({plate_on_sand(0.2, 0.6), second}), Pointers{"/loads/1/plate"});
  EXPECT_EQ(after([&](Scene& s) {
              s.loads = {plate_on_sand(0.2, 0.6), second};
              s.stages.push_back(s.stages[0]);
              s.stages[1].name = "then";
              s.stages[0].loads = std::vector<std::string>{"plate"};
              s.stages[1].loads = std::vector<std::string>{"second"};
            }),
            Pointers{});
}

TEST(CheckProbe, IsWhereSomethingCanBeSeen) {
  const auto probe = [](const Vec3& at, const char* quantity) {
    return after([&](Scene& s) {
      s.walls.resize(1);
      s.walls[0].block = box(0.6, 0.6, 0.8, 1);
      s.bodies[0].region.min[1] = 0.1;
      s.bodies.push_back({"filter", BodyKind::saturated_soil, "sand", box(0, 0, 1, 0.1), true, {}});
      s.output.probes = {{"p", at, quantity}};
    });
  };
  EXPECT_EQ(probe({0.7, 0.7, 0}, "head"), Pointers{"/output/probes/0/at"});
  EXPECT_EQ(probe({0.6, 0.7, 0}, "head"), Pointers{});  // on the block's face
  EXPECT_EQ(probe({0.8, 0.7, 0}, "head"), Pointers{});
  EXPECT_EQ(probe({0.7, 0.6, 0}, "head"), Pointers{});
  EXPECT_EQ(probe({0.5, 0.05, 0}, "head"), Pointers{});
  EXPECT_EQ(probe({0.5, 0.05, 0}, "soil_velocity"), Pointers{"/output/probes/0/at"});
}

}  // namespace
}  // namespace quicksand
