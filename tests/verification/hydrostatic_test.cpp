// Still water stays still: u = γw · depth.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/book.hpp"
#include "tests/verification/dimensions.hpp"

namespace quicksand::test {
namespace {

Soil sand(double porosity, double permeability, double young) {
  Soil s;
  s.porosity = porosity;
  s.permeability = {PermeabilityLaw::kozeny_carman, permeability, 0};
  s.model.law = SoilLaw::mohr_coulomb;
  s.model.young_modulus = young;
  s.model.poisson_ratio = 0.3;
  s.model.friction_angle = 30;
  return s;
}

Body body(const std::string& name, BodyKind kind, const Region& region, const std::string& soil = "") {
  Body b;
  b.name = name;
  b.kind = kind;
  b.soil = soil;
  b.region = region;
  return b;
}

Scene still(double width, double height, double h, double seconds) {
  Scene s;
  s.domain.max = {width, height, 0};
  s.domain.cell_size = h;
  Stage stage;
  stage.name = "rest";
  stage.duration = seconds;
  s.stages = {stage};
  s.output.frame_interval = seconds / 4;
  return s;
}

/// Every point of every frame: pressure against γw · depth, and stillness.
void expect_rest(const Scene& scene, double level, double speed) {
  const Recorded r = record(scene);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  double worst = 0, fastest = 0;
  for (const Frame& frame : r.results.frames) {
    const auto& p = field(frame, "pore_pressure");
    const auto& v = field(frame, "velocity");
    for (std::size_t i = 0; i < frame.points(); ++i) {
      const double expected = 9810 * (level - frame.position[3 * i + 1]);
      worst = std::max(worst, std::abs(p[i] - expected) / (9810 * level));
      fastest = std::max(fastest, static_cast<double>(std::hypot(v[3 * i], v[3 * i + 1])));
    }
  }
  std::printf("largest pressure error %.2e of γH, fastest point %.2e m/s\n", worst, fastest);
  EXPECT_LT(worst, 0.002);
  EXPECT_LT(fastest, speed);
  EXPECT_LT(r.report.ledger.water_volume_drift_max, 1e-4);
  EXPECT_LT(r.report.ledger.momentum_residual, 1e-9);
  EXPECT_EQ(r.report.ledger.water_mass, r.report.ledger.water_mass_initial);
}

TEST(Hydrostatic, SaturatedColumnUnderWater) {
  Scene s = still(0.1, 0.6, 0.01, 2);
  s.soils["sand"] = sand(0.4, 1e-4, 1e7);
  s.bodies = {body("sand", BodyKind::saturated_soil, box(0, 0, 0.1, 0.3), "sand"),
              body("water", BodyKind::water, box(0, 0.3, 0.1, 0.5))};
  expect_rest(s, 0.5, 1e-4);
}

TEST(Hydrostatic, LayeredGround) {
  Scene s = still(0.1, 0.6, 0.01, 1);
  s.soils["loose"] = sand(0.5, 1e-3, 5e6);
  s.soils["dense"] = sand(0.35, 1e-5, 5e7);
  s.bodies = {body("lower", BodyKind::saturated_soil, box(0, 0, 0.1, 0.2), "dense"),
              body("upper", BodyKind::saturated_soil, box(0, 0.2, 0.1, 0.4), "loose"),
              body("water", BodyKind::water, box(0, 0.4, 0.1, 0.5))};
  expect_rest(s, 0.5, 1e-3);
}

TEST(Hydrostatic, TankWithAStepAndAThinWall) {
  Scene s = still(0.4, 0.4, 0.02, 2);
  Wall step, pile;
  step.name = "step";
  step.block = box(0.2, 0, 0.4, 0.1);
  pile.name = "pile";
  pile.line = Segment{{0.3, 0.16, 0}, {0.3, 0.4, 0}};
  s.walls = {step, pile};
  s.bodies = {body("low", BodyKind::water, box(0, 0, 0.2, 0.3)),
              body("high", BodyKind::water, box(0.2, 0.1, 0.4, 0.3))};
  expect_rest(s, 0.3, 1e-6);
}

/// cases/hydrostatic: every point of every frame.
void hydrostatic_page(Scene scene, double seconds, const std::string& size) {
  constexpr double kLevel = 0.4, kWeight = 9810;  // m, N/m³
  scene.stages[0].duration = seconds;
  Page page("hydrostatic", size);
  const Recorded r = page.run(scene);
  double worst = 0, fastest = 0;
  Curve profile{"Pressure at the end", "p (kPa)", "height (m)", size, {}, {}};
  for (const Frame& frame : r.results.frames) {
    const auto& p = field(frame, "pore_pressure");
    const auto& v = field(frame, "velocity");
    for (std::size_t i = 0; i < frame.points(); ++i) {
      const double y = frame.position[3 * i + 1];
      worst = std::max(worst, std::abs(p[i] - kWeight * (kLevel - y)) / (kWeight * kLevel));
      fastest = std::max(fastest, static_cast<double>(std::hypot(v[3 * i], v[3 * i + 1], v[3 * i + 2])));
      if (&frame != &r.results.frames.back() || frame.phase[i] == 0) continue;
      profile.x.push_back(p[i] / 1e3), profile.result.push_back(y);
    }
  }
  profile.reference_x = {kWeight * kLevel / 1e3, 0};
  profile.reference = {0, kLevel};
  page.error("pressure, all points and frames", worst, 0.005, "γH");
  page.error("fastest point", fastest, 1e-3, "m/s");
  page.error("water volume, largest drift", r.report.ledger.water_volume_drift_max, 0.001, "–");
  page.curve(profile);
}

TEST(Hydrostatic, LayersAndAStepInTheFloor) {
  hydrostatic_page(load_case("hydrostatic", 2), 1, "cells of 20 mm, 1 s");
}
TEST(Hydrostatic, LayersAndAStepAboutAnAxis) {
  hydrostatic_page(about_axis(load_case("hydrostatic", 2)), 1, "cells of 20 mm, 1 s, about an axis");
}
TEST(Hydrostatic, LayersAndAStepInSpace) {
  hydrostatic_page(in_space(load_case("hydrostatic", 2), 0.04), 0.2, "cells of 20 mm, 0.2 s, space");
}
TEST(SlowHydrostatic, LayersAndAStepInTheFloor) {
  hydrostatic_page(load_case("hydrostatic"), 10, "cells of 10 mm, 10 s");
}
TEST(SlowHydrostatic, LayersAndAStepInSpace) {
  hydrostatic_page(in_space(load_case("hydrostatic", 2), 0.1), 2, "cells of 20 mm, 2 s, space");
}

/// No free surface anywhere: pressure zero at the lid.
TEST(Hydrostatic, FullTankWithAStep) {
  Scene s = still(0.4, 0.3, 0.02, 2);
  Wall step;
  step.name = "step";
  step.block = box(0.2, 0, 0.4, 0.1);
  s.walls = {step};
  s.bodies = {body("low", BodyKind::water, box(0, 0, 0.2, 0.3)),
              body("high", BodyKind::water, box(0.2, 0.1, 0.4, 0.3))};
  expect_rest(s, 0.3, 1e-6);
}

/// The same still water on a grid that its surface cuts anywhere: the surface is found at its true place.
TEST(Hydrostatic, SurfaceAtAnyHeightWithinACell) {
  for (const int rows : {7, 8}) {  // of half-cell points
    Scene s = still(0.1, 0.16, 0.02, 0.5);
    const double level = rows * 0.01;
    s.bodies = {body("water", BodyKind::water, box(0, 0, 0.1, level))};
    expect_rest(s, level, 1e-6);
  }
}

}  // namespace
}  // namespace quicksand::test
