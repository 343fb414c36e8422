// The same answers in the plane, about an axis and in space, from one path of code.

#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/check.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand::test {
namespace {

Soil sand(double porosity, double permeability, double young) {
  Soil s;
  s.porosity = porosity;
  s.permeability = {.law = PermeabilityLaw::constant, .value = permeability};
  s.model = {.young_modulus = young, .poisson_ratio = 0.3};
  return s;
}

Body body(const std::string& name, BodyKind kind, const Vec3& min, const Vec3& max,
          const std::string& soil = "") {
  Body b;
  b.name = name;
  b.kind = kind;
  b.soil = soil;
  b.region.min = min;
  b.region.max = max;
  return b;
}

Scene scene(Dimension dimension, const Vec3& size, double h, double seconds) {
  Scene s;
  s.domain.dimension = dimension;
  s.domain.max = size;
  s.domain.cell_size = h;
  Stage stage;
  stage.name = "only";
  stage.duration = seconds;
  s.stages = {stage};
  s.output.frame_interval = seconds / 4;
  s.output.series_interval = seconds / 100;
  return s;
}

/// Every point of every frame against still water of the given level.
void expect_rest(const Scene& s, double level, double speed) {
  const Recorded r = record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  double worst = 0, fastest = 0;
  for (const Frame& frame : r.results.frames) {
    const auto& p = field(frame, "pore_pressure");
    const auto& v = field(frame, "velocity");
    for (std::size_t i = 0; i < frame.points(); ++i) {
      const double expected = 9810 * (level - frame.position[3 * i + 1]);
      worst = std::max(worst, std::abs(p[i] - expected) / (9810 * level));
      fastest = std::max<double>(fastest, std::hypot(v[3 * i], v[3 * i + 1], v[3 * i + 2]));
    }
  }
  std::printf("largest pressure error %.2e of γH, fastest point %.2e m/s\n", worst, fastest);
  EXPECT_LT(worst, 0.002);
  EXPECT_LT(fastest, speed);
  EXPECT_LT(r.report.ledger.water_volume_drift_max, 1e-4);
  EXPECT_LT(r.report.ledger.momentum_residual, 1e-9);
  EXPECT_EQ(r.report.ledger.water_mass, r.report.ledger.water_mass_initial);
}

/// Layered ground under and beside free water, a step in the floor, a pile of no thickness over half the
/// depth, closed sides.
TEST(Space, ClosedTankWithAStepStaysAtRest) {
  Scene s = scene(Dimension::space, {0.4, 0.4, 0.2}, 0.05, 0.5);
  s.soils = {{"loose", sand(0.5, 1e-2, 5e6)}, {"dense", sand(0.35, 1e-3, 2e7)}};
  Wall step, pile;
  step.name = "step";
  step.block = body("", BodyKind::soil, {0.2, 0, 0}, {0.4, 0.1, 0.2}).region;
  pile.name = "pile";
  pile.line = Segment{{0.3, 0.15, 0}, {0.3, 0.4, 0.1}};
  s.walls = {step, pile};
  s.bodies = {body("lower", BodyKind::saturated_soil, {0, 0, 0}, {0.2, 0.1, 0.2}, "dense"),
              body("upper", BodyKind::saturated_soil, {0, 0.1, 0}, {0.2, 0.2, 0.2}, "loose"),
              body("above", BodyKind::water, {0, 0.2, 0}, {0.2, 0.3, 0.2}),
              body("beside", BodyKind::water, {0.2, 0.1, 0}, {0.4, 0.3, 0.2})};
  ASSERT_TRUE(check(s).empty());
  expect_rest(s, 0.3, 1e-3);
}

/// Water at two levels stays so beside a wall of no thickness, and grains on one side of it do not feel the
/// load on the other.
TEST(Space, NothingPassesAThinWall) {
  Scene s = scene(Dimension::space, {0.4, 0.4, 0.2}, 0.05, 0.2);
  s.soils = {{"sand", sand(0.4, 1e-3, 1e7)}};
  Wall pile;
  pile.name = "pile";
  pile.line = Segment{{0.2, 0, 0}, {0.2, 0.4, 0.2}};
  s.walls = {pile};
  s.bodies = {body("left", BodyKind::saturated_soil, {0, 0, 0}, {0.2, 0.2, 0.2}, "sand"),
              body("pool", BodyKind::water, {0, 0.2, 0}, {0.2, 0.3, 0.2}),
              body("right", BodyKind::soil, {0.2, 0, 0}, {0.4, 0.2, 0.2}, "sand")};
  Load load;
  load.name = "fill";
  load.body = "right";
  load.traction = {0, -2e4, 0};
  load.ramp = 0.05;
  s.loads = {load};
  ASSERT_TRUE(check(s).empty());
  const Recorded r = record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  double worst = 0, moved_left = 0, moved_right = 0;
  const Frame& last = r.results.frames.back();
  const auto& p = field(last, "pore_pressure");
  const auto& u = field(last, "displacement");
  for (std::size_t i = 0; i < last.points(); ++i) {
    const double x = last.position[3 * i], y = last.position[3 * i + 1];
    ASSERT_EQ(x > 0.2, last.body[i] == 2) << "a point passed the wall";
    if (last.body[i] != 2) worst = std::max(worst, std::abs(p[i] - 9810 * (0.3 - y)) / (9810 * 0.3));
    double& moved = last.body[i] == 2 ? moved_right : moved_left;
    if (last.phase[i] == 0) moved = std::max<double>(moved, std::hypot(u[3 * i], u[3 * i + 1], u[3 * i + 2]));
  }
  std::printf("pressure error %.1e of γH, grains moved %.1e m beside the wall, %.1e m under the load\n",
              worst, moved_left, moved_right);
  EXPECT_LT(worst, 0.002);
  EXPECT_GT(moved_right, 1e-4);
  EXPECT_LT(moved_left, 0.01 * moved_right);
}

/// Terzaghi's column: pressure at its base over T ≤ 1.
Recorded consolidation(Dimension dimension, int cells) {
  constexpr double kPermeability = 1e-3, kYoung = 1e7, kLoad = 1e4;
  const double h = 1.0 / cells, modulus = kYoung * 0.7 / (1.3 * 0.4);
  Scene s = scene(dimension, {2 * h, 1 + 4 * h, 2 * h}, h, 9810 / (kPermeability * modulus));
  s.gravity = {};
  s.soils = {{"soil", sand(0.4, kPermeability, kYoung)}};
  s.bodies = {body("column", BodyKind::saturated_soil, {0, 0, 0}, {2 * h, 1, 2 * h}, "soil")};
  Load load;
  load.name = "load";
  load.body = "column";
  load.traction = {0, -kLoad, 0};
  s.loads = {load};
  s.initial.pressure = InitialPressure::uniform;
  s.initial.uniform_pressure = kLoad;
  s.initial.stress = InitialStress::zero;
  Probe probe;
  probe.name = "base";
  probe.at = {h, 1e-6, h};
  probe.quantity = "pore_pressure";
  s.output.probes = {probe};
  EXPECT_TRUE(check(s).empty());
  Recorded r = record(s);
  EXPECT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  return r;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double worst = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

/// What holds of the plane (terzaghi_test.cpp) holds of every other dimension.
void expect_as_in_the_plane(Dimension dimension) {
  const Recorded plane = consolidation(Dimension::plane_strain, 10), other = consolidation(dimension, 10);
  const double difference =
      largest_difference(plane.results.series("probe.base"), other.results.series("probe.base"));
  std::printf("largest difference of the base pressure to the plane's: %.1e of the load\n", difference / 1e4);
  EXPECT_GT(plane.results.series("probe.base").front(), 0.99e4);
  EXPECT_LT(difference, 1e-4 * 1e4);  // the pressure is solved for to 1e-6 of a step's change
}

TEST(Space, ConsolidatesAsThePlaneDoes) { expect_as_in_the_plane(Dimension::space); }
TEST(Axisymmetric, ConsolidatesAsThePlaneDoes) { expect_as_in_the_plane(Dimension::axisymmetric); }

/// Layered ground about the axis, a step in the floor outside, a pile of no thickness.
TEST(Axisymmetric, ClosedTankWithAStepStaysAtRest) {
  Scene s = scene(Dimension::axisymmetric, {0.4, 0.4, 0}, 0.025, 0.5);
  s.soils = {{"loose", sand(0.5, 1e-2, 5e6)}, {"dense", sand(0.35, 1e-3, 2e7)}};
  Wall step, pile;
  step.name = "step";
  step.block = body("", BodyKind::soil, {0.2, 0, 0}, {0.4, 0.1, 0}).region;
  pile.name = "pile";
  pile.line = Segment{{0.3, 0.15, 0}, {0.3, 0.4, 0}};
  s.walls = {step, pile};
  s.bodies = {body("lower", BodyKind::saturated_soil, {0, 0, 0}, {0.2, 0.1, 0}, "dense"),
              body("upper", BodyKind::saturated_soil, {0, 0.1, 0}, {0.2, 0.2, 0}, "loose"),
              body("above", BodyKind::water, {0, 0.2, 0}, {0.2, 0.3, 0}),
              body("beside", BodyKind::water, {0.2, 0.1, 0}, {0.4, 0.3, 0})};
  ASSERT_TRUE(check(s).empty());
  expect_rest(s, 0.3, 1e-3);
}

/// A full cylinder under even pressure bears it everywhere, σrr = σθθ = −p, and shrinks by u = −p r
/// (1+ν)(1−2ν)/E.
TEST(Axisymmetric, PressedCylinderIsUniform) {
  constexpr double kPressure = 1e3, kYoung = 1e7, kPoisson = 0.3;
  Scene s = scene(Dimension::axisymmetric, {1.2, 0.1, 0}, 0.05, 1.2);
  s.gravity = {};
  s.soils = {{"soil", sand(0.4, 1e-3, kYoung)}};
  s.bodies = {body("cylinder", BodyKind::soil, {0, 0, 0}, {1, 0.1, 0}, "soil")};
  Load load;
  load.name = "pressure", load.body = "cylinder", load.side = BodySide::right;
  load.traction = {-kPressure, 0, 0}, load.ramp = 1;
  s.loads = {load};
  s.initial.stress = InitialStress::zero;
  s.numerics.pic_rate = 1000;
  const Recorded r = record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const Frame& last = r.results.frames.back();
  const auto& stress = field(last, "effective_stress");
  const auto& u = field(last, "displacement");
  double off_axis = 0, beside_axis = 0, moved = 0;
  for (std::size_t i = 0; i < last.points(); ++i) {
    const double at = last.position[3 * i] - u[3 * i];
    const double expected = -kPressure * at * (1 + kPoisson) * (1 - 2 * kPoisson) / kYoung;
    moved = std::max(moved, std::abs(u[3 * i] - expected));
    double& error = at < 0.1 ? beside_axis : off_axis;
    for (int k : {0, 2}) error = std::max(error, std::abs(stress[4 * i + k] / -kPressure - 1));
  }
  moved /= kPressure * (1 + kPoisson) * (1 - 2 * kPoisson) / kYoung;
  std::printf("stress off by %.4f, beside the axis %.4f; displacement %.4f of the largest\n", off_axis,
              beside_axis, moved);
  EXPECT_LT(off_axis, 0.01);
  EXPECT_LT(beside_axis, 0.04);
  EXPECT_LT(moved, 0.01);
}

}  // namespace
}  // namespace quicksand::test
