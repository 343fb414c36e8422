#include "tests/engine/scene/basin.hpp"

namespace quicksand {
namespace {

using namespace test;

TEST(Check, ASoundSceneHasNoFault) { EXPECT_EQ(faults_of(basin()), Pointers{}); }

TEST(Check, ScalesDoNotMatter) {
  for (const double scale : {1e-6, 1e-3, 1e3}) {
    Scene s = basin();
    s.domain.cell_size *= scale;
    for (Vec3* v : {&s.domain.max, &s.bodies[0].region.max, &s.bodies[1].region.min, &s.bodies[1].region.max})
      for (double& x : *v) x *= scale;
    EXPECT_EQ(faults_of(s), Pointers{}) << scale;
  }
}

TEST(Check, OriginsThatAreNotRoundDoNotMatter) {
  Scene s = basin();
  const Vec3 shift{-123.456789, 0.1234567, 0};
  for (Vec3* v : {&s.domain.min, &s.domain.max, &s.bodies[0].region.min, &s.bodies[0].region.max,
                  &s.bodies[1].region.min, &s.bodies[1].region.max})
    for (std::size_t k = 0; k < 3; ++k) (*v)[k] += shift[k];
  s.bodies[0].fixed = true;
  EXPECT_EQ(faults_of(s), Pointers{});
}

/// Moduli below the weight that they bear: soil of 2.9 kPa (under water), water of 5.9 kPa.
TEST(Check, WhatItsOwnWeightWouldCrushIsRefused) {
  const auto with_soil = [](double young) {
    return after([young](Scene& s) { s.soils["sand"].model.young_modulus = young; });
  };
  EXPECT_EQ(with_soil(3000), Pointers{});
  EXPECT_EQ(with_soil(2800), Pointers{"/materials/soils/sand/model/young_modulus"});
  const auto with_water = [](double bulk) {
    return after([bulk](Scene& s) { s.water.bulk_modulus = bulk; });
  };
  EXPECT_EQ(with_water(6000), Pointers{});
  EXPECT_EQ(with_water(5800), Pointers{"/materials/water/bulk_modulus"});
  EXPECT_EQ(after([](Scene& s) {
              s.water.bulk_modulus = 5800;
              s.gravity = {0, -1, 0};
            }),
            Pointers{});
}

TEST(Check, HatsNeedTwoPointsInSoil) {
  const auto with = [](Kernel kernel, int points) {
    return after([=](Scene& s) { s.numerics.kernel = kernel, s.numerics.points_per_cell = points; });
  };
  EXPECT_EQ(with(Kernel::linear, 1), Pointers{"/numerics/points_per_cell"});
  EXPECT_EQ(with(Kernel::linear, 2), Pointers{});
  EXPECT_EQ(with(Kernel::quadratic, 1), Pointers{});
}

TEST(Check, EmptyAndOversizedGrids) {
  EXPECT_EQ(after([](Scene& s) { s.domain.cell_size = 0; }), Pointers{"/domain/cell_size"});
  EXPECT_EQ(after([](Scene& s) { s.domain.max[0] = 0; }), Pointers{"/domain/max"});
  EXPECT_EQ(after([](Scene& s) { s.domain.max[1] = 1.05; }), Pointers{"/domain/max"});
  EXPECT_EQ(after([](Scene& s) { s.domain.cell_size = 1e-4; }), Pointers{"/domain/cell_size"});
}

TEST(Check, PresetsDecideWhichFacesThereAre) {
  const auto with_factor = [](double factor) {
    return after([factor](Scene& s) {
      s.numerics.cell_size_factor = factor;
      s.walls.resize(1);
      s.walls[0].line = Segment{{0.7, 0.5, 0}, {0.7, 1, 0}};
    });
  };
  EXPECT_EQ(with_factor(1), Pointers{});
  EXPECT_EQ(with_factor(0.5), Pointers{});
  EXPECT_EQ(with_factor(2),
            (Pointers{"/walls/0/line/from", "/walls/0/line/to"}));  // 0.5 and 0.7 lie within cells
}

TEST(Check, OverlapsAreFoundPointByPoint) {
  // Points lie at 0.025, 0.075, …: an overlap that no point sees is none.
  EXPECT_EQ(after([](Scene& s) { s.bodies[1].region.min[1] = 0.28; }), Pointers{});
  EXPECT_EQ(after([](Scene& s) { s.bodies[1].region.min[1] = 0.27; }), Pointers{"/bodies/1/region"});
  const auto faults = [] {
    Scene s = basin();
    s.bodies[1].region.min[1] = 0.27;
    return check(s);
  }();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_NE(faults[0].detail.find("(20 points)"), std::string::npos) << faults[0].detail;
  EXPECT_NE(faults[0].detail.find("near (0.025, 0.275)"), std::string::npos) << faults[0].detail;
}

TEST(Check, ThreeBodiesInOnePlaceAreAllNamed) {
  EXPECT_EQ(after([](Scene& s) {
              for (const char* name : {"a", "b"})
                s.bodies.push_back({name, BodyKind::water, "", box(0.2, 0.4, 0.4, 0.5), false, {}});
            }),
            (Pointers{"/bodies/2/region", "/bodies/3/region"}));
}

TEST(Check, BodiesKeepOutOfBlocks) {
  const auto with_block = [](const Region& block) {
    return after([&](Scene& s) {
      s.walls.resize(1);
      s.walls[0].block = block;
    });
  };
  EXPECT_EQ(with_block(box(0.4, 0.6, 0.6, 1)), Pointers{});
  EXPECT_EQ(with_block(box(0.4, 0.2, 0.6, 0.5)), (Pointers{"/bodies/0/region", "/bodies/1/region"}));
}

TEST(Check, FixedBodiesFillWholeCells) {
  const auto fixed = [](const Region& region) {
    return after([&](Scene& s) {
      s.bodies[0].fixed = true;
      s.bodies[0].region = region;
      s.bodies.pop_back();
    });
  };
  Region steps = box(0, 0, 1, 0.3);
  EXPECT_EQ(fixed(steps), Pointers{});
  Region corner;
  corner.kind = Region::Kind::difference;
  corner.parts = {box(0, 0, 1, 0.3), box(0.5, 0.2, 1, 0.3)};
  EXPECT_EQ(fixed(corner), Pointers{});
  corner.parts[1] = box(0.55, 0.2, 1, 0.3);  // half a cell
  EXPECT_EQ(fixed(corner), Pointers{"/bodies/0/region"});
  EXPECT_EQ(fixed(box(0, 0, 1, 0.29)), Pointers{"/bodies/0/region"});
}

TEST(Check, ReservoirsAndSectionsLieOnTheirLines) {
  const auto pointers = after([](Scene& s) {
    s.reservoirs = {{"lake", {{0.5, 0, 0}, {0.5, 0.4, 0}}, 1}};
    s.output.sections = {{"cut", {{0.5, 0, 0}, {0.5, 0.43, 0}}, "flow"}};
    s.stages[0].heads = {{"sea", 1}};
  });
  EXPECT_EQ(pointers, (Pointers{"/output/sections/0/line/to", "/reservoirs/0/line", "/stages/0/heads/sea"}));
}

TEST(Check, StagesTakeBodiesOnceAndReachTheirHeads) {
  const auto two = [](const std::function<void(Scene&)>& change) {
    return after([&](Scene& s) {
      s.stages.push_back(s.stages[0]);
      s.stages[1].name = "after";
      Load load;
      load.name = "cover", load.body = "sand", load.traction = {0, -10, 0};
      s.loads = {load};
      s.reservoirs = {{"lake", {{0, 0.3, 0}, {0, 0.6, 0}}, 0.6}};
      change(s);
    });
  };
  EXPECT_EQ(two([](Scene&) {}), Pointers{});
  EXPECT_EQ(two([](Scene& s) {
              s.stages[1].heads = {{"lake", 0.5}};
              s.stages[1].heads_ramp = 1.5;
            }),
            Pointers{"/stages/1/heads_ramp"});
  EXPECT_EQ(two([](Scene& s) { s.stages[1].remove_bodies = {"sand"}; }), Pointers{});
  EXPECT_EQ(two([](Scene& s) { s.stages[0].remove_bodies = {"sand"}; }), Pointers{"/loads/0"});
  EXPECT_EQ(two([](Scene& s) { s.stages[0].remove_bodies = s.stages[1].remove_bodies = {"water"}; }),
            Pointers{"/stages/1/remove_bodies/0"});
  EXPECT_EQ(two([](Scene& s) {
              s.stages[1].remove_bodies = {"water", "sand"};
            }),
            Pointers{"/stages/1/remove_bodies"});
  EXPECT_EQ(two([](Scene& s) {
              s.stages[1].remove_bodies = {"sand"};
              s.stages[1].loads = std::vector<std::string>{"cover"};
            }),
            Pointers{"/stages/1/loads/0"});
}

TEST(Check, LawsHoldSensibleValues) {
  const auto model = [](const std::function<void(SoilModel&)>& change) {
    return after([&](Scene& s) { change(s.soils["sand"].model); });
  };
  const auto cam_clay = [](double swelling) {
    return SoilModel{.law = SoilLaw::modified_cam_clay,
                     .poisson_ratio = 0.2,
                     .compression_slope = 0.2,
                     .swelling_slope = swelling,
                     .critical_state_slope = 1};
  };
  EXPECT_EQ(model([&](SoilModel& m) { m = cam_clay(0.04); }), Pointers{});
  EXPECT_EQ(model([&](SoilModel& m) { m = cam_clay(0.2); }),
            Pointers{"/materials/soils/sand/model/swelling_slope"});
  EXPECT_EQ(model([](SoilModel& m) { m.cohesion = 100, m.residual_cohesion = 10, m.softening_strain = 0.1; }),
            Pointers{});
  EXPECT_EQ(model([](SoilModel& m) { m.cohesion = 100, m.residual_cohesion = 10; }),
            Pointers{"/materials/soils/sand/model/softening_strain"});
  EXPECT_EQ(model([](SoilModel& m) { m.cohesion = 100, m.softening_strain = 0.1; }),
            Pointers{"/materials/soils/sand/model/softening_strain"});
  EXPECT_EQ(
      model([](SoilModel& m) { m.cohesion = 100, m.residual_cohesion = 100, m.softening_strain = 0.1; }),
      Pointers{"/materials/soils/sand/model/residual_cohesion"});
  EXPECT_EQ(model([](SoilModel& m) { m.cohesion = 100, m.tension_cutoff = 173; }),
            Pointers{});  // apex: 173.2
  EXPECT_EQ(model([](SoilModel& m) { m.cohesion = 100, m.tension_cutoff = 174; }),
            Pointers{"/materials/soils/sand/model/tension_cutoff"});
  EXPECT_EQ(model([](SoilModel& m) {
              m.friction_angle = m.dilation_angle = 0, m.cohesion = 100, m.tension_cutoff = 1e9;
            }),
            Pointers{});
}

TEST(Check, K0ActsWhereSoilMoves) {
  EXPECT_EQ(after([](Scene& s) { s.initial.k0 = 0.5; }), Pointers{});
  EXPECT_EQ(after([](Scene& s) { s.soils["sand"].k0 = 0.5; }), Pointers{});
  EXPECT_EQ(after([](Scene& s) { s.soils["sand"].k0 = s.initial.k0 = 0.5; }), Pointers{"/initial/k0"});
  EXPECT_EQ(after([](Scene& s) {
              s.soils["sand"].k0 = 0.5;
              s.bodies[0].fixed = true;
            }),
            Pointers{"/materials/soils/sand/k0"});
}

TEST(Check, UnknownNamesListTheKnownOnes) {
  Scene s = basin();
  s.bodies[0].soil = "silt";
  s.stages[0].open_gates = {"door"};
  s.stages[0].remove_bodies = {"house"};
  const auto said = [&](const std::string& pointer) {
    for (const Fault& fault : check(s))
      if (fault.pointer == pointer) return fault.detail;
    return std::string();
  };
  EXPECT_EQ(said("/bodies/0/soil"), "there is no soil \"silt\": there is \"sand\"");
  EXPECT_EQ(said("/stages/0/open_gates/0"), "there is no gate \"door\": the case has none");
  EXPECT_EQ(said("/stages/0/remove_bodies/0"),
            "there is no body \"house\": there are \"sand\" and \"water\"");
}

TEST(Check, TooManyEdgesAreRefusedRatherThanSlow) {
  EXPECT_EQ(after([](Scene& s) {
              Region many;
              many.kind = Region::Kind::union_of;
              many.parts.assign(6000, box(0, 0.3, 1, 0.6));
              s.bodies[1].region = many;
            }),
            Pointers{"/bodies"});
}

TEST(Check, HoldsForAnyGravity) {
  EXPECT_EQ(after([](Scene& s) { s.gravity = {1, -9.7, 0}; }), Pointers{"/initial/stress"});
  EXPECT_EQ(after([](Scene& s) {
              s.gravity = {1, -9.7, 0};
              s.initial.stress = InitialStress::zero;
            }),
            Pointers{});
  EXPECT_EQ(after([](Scene& s) {
              s.gravity = {0, 0, 0};
              s.initial.water_table = 0.6;
              s.initial.k0 = 0.5;
            }),
            (Pointers{"/initial/k0", "/initial/water_table"}));
}

}  // namespace
}  // namespace quicksand
