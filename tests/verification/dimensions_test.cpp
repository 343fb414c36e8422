// The same answers in the plane, about an axis and in space, from one path of code.

#include "tests/verification/dimensions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/scene/check.hpp"
#include "tests/verification/book.hpp"

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

/// Terzaghi's series for the excess pressure at the base, of the load.
double base_pressure(double t) {
  double sum = 0;
  for (int m = 0; m < 200; ++m) {
    const double a = (2 * m + 1) * std::numbers::pi / 2;
    sum += 2 / a * std::sin(a) * std::exp(-a * a * t);
  }
  return sum;
}

constexpr double kLoad = 1e3;  // Pa, of cases/terzaghi

std::vector<double> base_of(const Recorded& r) {
  std::vector<double> p = r.results.series("probe.base");
  for (double& value : p) value /= kLoad;
  return p;
}

/// What holds of the plane (terzaghi_test.cpp) holds of every other dimension.
void terzaghi_page(const Scene& plane, const Scene& other, const std::string& name) {
  Page page("terzaghi", "k = 0.001 m/s, 20 cells, " + name);
  const Recorded r = page.run(other);
  const std::vector<double> p = base_of(r), of_plane = base_of(record(plane));
  ASSERT_EQ(p.size(), of_plane.size());
  double error = 0, difference = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double t = r.results.times[i] / r.results.times.back();
    if (t >= 0.05) error = std::max(error, std::abs(p[i] - base_pressure(t)));
    difference = std::max(difference, std::abs(p[i] - of_plane[i]));
  }
  page.error("pressure at the base", error, 0.01, "of the load");
  // The pressure is solved for to 1e-6 of what a step changes.
  page.error("pressure at the base against the plane's", difference, 2e-4, "of the load");
}

TEST(Space, ConsolidatesAsThePlaneDoes) {
  const Scene plane = load_case("terzaghi");
  terzaghi_page(plane, in_space(plane, plane.domain.max[0]), "space");
}

TEST(Axisymmetric, ConsolidatesAsThePlaneDoes) {
  const Scene plane = load_case("terzaghi");
  terzaghi_page(plane, about_axis(plane), "about an axis");
}

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

/// Struck at once and without any damping, a cylinder rings on: the chosen step is stable beside the axis
/// too.
TEST(Axisymmetric, StruckCylinderRingsOnWithItsEnergy) {
  Scene s = scene(Dimension::axisymmetric, {1.2, 0.1, 0}, 0.05, 3);
  s.gravity = {};
  s.soils = {{"soil", sand(0.4, 1e-3, 1e7)}};
  s.bodies = {body("cylinder", BodyKind::soil, {0, 0, 0}, {1, 0.1, 0}, "soil")};
  Load load;
  load.name = "pressure", load.body = "cylinder", load.side = BodySide::right;
  load.traction = {-1e3, 0, 0};
  s.loads = {load};
  s.initial.stress = InitialStress::zero;
  s.numerics.pic_rate = 0;
  s.numerics.time_step_factor = 1;
  const Recorded r = record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const auto kinetic = r.results.series("ledger.energy_kinetic");
  const auto half = kinetic.begin() + static_cast<std::ptrdiff_t>(kinetic.size() / 2);
  const double early = *std::max_element(kinetic.begin(), half),
               late = *std::max_element(half, kinetic.end());
  std::printf("kinetic energy %.3g J per radian, later %.3g J; %ld steps\n", early, late, r.report.steps);
  EXPECT_GT(late, 0);
  EXPECT_LT(late, 1.1 * early);
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
