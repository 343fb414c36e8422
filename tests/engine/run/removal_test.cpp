// Bodies that stages take away: what leaves with them, and what is left.

#include "engine/run/removal.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/run/setup.hpp"
#include "tests/engine/small_scene.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand::test {
namespace {

constexpr double kGamma = 9810;

/// Adds a stage of `duration` that removes `bodies`.
Stage& then_remove(Scene& s, const std::vector<std::string>& bodies, double duration) {
  Stage stage;
  stage.name = "after " + std::to_string(s.stages.size());
  stage.duration = duration;
  stage.remove_bodies = bodies;
  s.stages.push_back(stage);
  return s.stages.back();
}

double balance(double now, double out, double removed, double before, double in) {
  return std::abs(now + out + removed - before - in) / (before + in);
}
void expect_balanced(const RunReport& r) {
  ASSERT_EQ(r.status, RunStatus::succeeded) << r.failure.message;
  const Ledger& l = r.ledger;
  if (l.water_mass_initial > 0) {
    EXPECT_LT(balance(l.water_mass, l.water_out, l.water_removed, l.water_mass_initial, l.water_in), 1e-12);
  }
  if (l.solid_mass_initial > 0) {
    EXPECT_LT(balance(l.solid_mass, l.soil_out, l.soil_removed, l.solid_mass_initial, 0), 1e-12);
  }
  EXPECT_LT(l.momentum_residual, 1e-10);
}

/// Points of a body in a frame.
long points_of(const Frame& frame, int body) {
  return std::count(frame.body.begin(), frame.body.end(), body);
}

/// Saturated ground of two halves under a pond.
Scene ground_under_water(double duration) {
  Scene s = plane(1, 0.8, 0.05, duration);
  add_body(s, "ground", BodyKind::saturated_soil, {0, 0, 0}, {1, 0.3, 0});
  add_body(s, "cut", BodyKind::saturated_soil, {0, 0.3, 0}, {0.5, 0.4, 0});
  add_body(s, "pond", BodyKind::water, {0, 0.4, 0}, {0.5, 0.6, 0});
  add_body(s, "beside", BodyKind::water, {0.5, 0.3, 0}, {1, 0.6, 0});
  s.soils["sand"].permeability.value = 1e-2;
  s.output.frame_interval = duration;
  return s;
}

TEST(Removal, TakesGrainsAndTheWaterBetweenThem) {
  Scene s = ground_under_water(0.05);
  then_remove(s, {"cut"}, 0.05);
  const Recorded r = record(s);
  expect_balanced(r.report);
  const Ledger& l = r.report.ledger;
  EXPECT_NEAR(l.soil_removed, 0.6 * 2650 * 0.5 * 0.1, 1e-9);
  EXPECT_NEAR(l.water_removed, 0.4 * 1000 * 0.5 * 0.1, 1e-9);
  const auto& frames = r.results.frames;
  EXPECT_EQ(points_of(frames[1], 1), 2 * 10 * 2 * 4);
  EXPECT_EQ(points_of(frames.back(), 1), 0);
  for (const int body : {0, 2, 3}) EXPECT_EQ(points_of(frames.back(), body), points_of(frames[0], body));
  EXPECT_EQ(r.results.last("ledger.soil_removed"), l.soil_removed);
  EXPECT_EQ(r.results.series("ledger.water_removed").front(), 0);
}

/// Grains and drops that have left the place where they began go as well, with their momentum.
TEST(Removal, TakesMovedPointsWithTheirMomentum) {
  for (const Dimension dimension : {Dimension::plane_strain, Dimension::axisymmetric}) {
    Scene s = plane(1, 1, 0.05, 0.1);
    s.domain.dimension = dimension;
    add_body(s, "lump", BodyKind::saturated_soil, {0.2, 0.5, 0}, {0.4, 0.7, 0});
    add_body(s, "stays", BodyKind::saturated_soil, {0.6, 0, 0}, {1, 0.2, 0});
    s.initial.stress = InitialStress::zero;
    s.initial.pressure = InitialPressure::zero;
    then_remove(s, {"lump"}, 0.1);
    s.output.frame_interval = 0.1;
    const Recorded r = record(s);
    expect_balanced(r.report);
    const Ledger& l = r.report.ledger;
    const double fallen = 9.81 * 0.1;  // m/s
    EXPECT_NEAR(l.impulse_removed[1], (l.soil_removed + l.water_removed) * fallen,
                1e-3 * l.soil_removed * fallen);
    EXPECT_EQ(points_of(r.results.frames.back(), 0), 0);
  }
}

TEST(Removal, TakesABodyBeforeTheFirstStep) {
  Scene s = ground_under_water(0.05);
  s.stages[0].remove_bodies = {"pond", "beside"};
  const Recorded r = record(s);
  expect_balanced(r.report);
  EXPECT_GT(points_of(r.results.frames.front(), 2), 0);  // the start shows the whole scene
  EXPECT_EQ(points_of(r.results.frames.back(), 2), 0);
}

/// A hole under water fills from all sides; what is left comes to rest with the pressure of its level, as far
/// as cells of half the hole's height tell a void from water.
TEST(Removal, WaterFlowsIntoAnExcavation) {
  Scene s = plane(1, 0.8, 0.1, 0.2);
  add_body(s, "ground", BodyKind::saturated_soil, {0, 0, 0}, {1, 0.2, 0});
  add_body(s, "cut", BodyKind::saturated_soil, {0, 0.2, 0}, {0.5, 0.4, 0});
  add_body(s, "pond", BodyKind::water, {0, 0.4, 0}, {0.5, 0.6, 0});
  add_body(s, "beside", BodyKind::water, {0.5, 0.2, 0}, {1, 0.6, 0});
  s.soils["sand"].permeability.value = 1e-2;
  Stage& after = then_remove(s, {"cut"}, 20);
  after.damping = 0.3;
  after.until_rest = UntilRest{5e-3, 1};
  s.output.frame_interval = 0.5;
  const Recorded r = record(s);
  expect_balanced(r.report);
  EXPECT_LT(r.report.sim_time, 19);
  const double level = 0.6 - 0.5 * 0.2;  // the cut's volume over the whole width
  const Frame& last = r.results.frames.back();
  const auto& p = field(last, "pore_pressure");
  for (std::size_t i = 0; i < last.points(); ++i)
    EXPECT_NEAR(p[i], kGamma * std::max(0.0, level - last.position[3 * i + 1]), 0.06 * kGamma * level);
  EXPECT_LT(r.report.ledger.water_volume_drift_max, 0.07);  // voids finer than the cells stay in the hole
}

TEST(Removal, WithoutTheirPondGrainsStayWet) {
  Scene s = ground_under_water(0.05);
  then_remove(s, {"pond", "beside", "cut"}, 0.5);
  const Recorded r = record(s);
  expect_balanced(r.report);
  const Frame& last = r.results.frames.back();
  const auto& p = field(last, "pore_pressure");
  for (std::size_t i = 0; i < last.points(); ++i)
    EXPECT_NEAR(p[i], kGamma * (0.3 - last.position[3 * i + 1]), 0.02 * kGamma * 0.3);
  EXPECT_LT(r.results.last("max_speed"), 1e-2);
}

/// Grains rest on a fixed body until it goes; then they fall, and the water is no longer dragged there.
TEST(Removal, AFixedBodyNoLongerHolds) {
  Scene s = plane(0.4, 0.6, 0.05, 0.1);
  add_body(s, "table", BodyKind::soil, {0, 0.2, 0}, {0.4, 0.3, 0});
  s.bodies[0].fixed = true;
  add_body(s, "sand", BodyKind::soil, {0, 0.3, 0}, {0.4, 0.4, 0});
  then_remove(s, {"table"}, 0.1);
  s.output.frame_interval = 0.1;
  const Recorded r = record(s);
  expect_balanced(r.report);
  const auto rise = r.results.series("body.sand.rise");
  EXPECT_NEAR(rise[10], 0, 1e-4);
  EXPECT_NEAR(rise.back(), -0.5 * 9.81 * 0.01, 2e-3);
  EXPECT_NEAR(r.report.ledger.soil_removed, 0.6 * 2650 * 0.4 * 0.1, 1e-9);

  State<2> state = make_state<2>(s);
  EXPECT_TRUE(state.soil_walls.blocked(state.grid.index({2, 5})));
  remove_bodies(s, s.stages[1], state);
  enter_stage(s, s.stages[1], state);
  EXPECT_EQ(state.fixed.size(), 0u);
  EXPECT_FALSE(state.soil_walls.blocked(state.grid.index({2, 5})));
}

/// Of two fixed bodies the one that is left still resists.
TEST(Removal, TheOtherFixedBodyStillResists) {
  Scene s = plane(0.2, 0.5, 0.05, 0.2);
  add_body(s, "filter", BodyKind::saturated_soil, {0, 0, 0}, {0.2, 0.1, 0});
  add_body(s, "plug", BodyKind::saturated_soil, {0, 0.1, 0}, {0.2, 0.2, 0});
  for (Body& body : s.bodies) body.fixed = true;
  add_body(s, "pool", BodyKind::water, {0, 0.2, 0}, {0.2, 0.4, 0});
  then_remove(s, {"plug"}, 1);
  State<2> state = make_state<2>(s);
  remove_bodies(s, s.stages[1], state);
  enter_stage(s, s.stages[1], state);
  look_again(state);
  const int inside = state.grid.index({2, 1}), above = state.grid.index({2, 3});
  EXPECT_NEAR(state.fixed_face[0][inside].phi, 0.6, 0.2);
  EXPECT_EQ(state.fixed_face[0][above].phi, 0);
  EXPECT_NEAR(state.cell[above].n, 1, 0.2);
  expect_balanced(record(s).report);
}

TEST(Removal, LoadsOnABodyEndWithIt) {
  Scene s = plane(0.4, 0.6, 0.05, 0.05);
  add_body(s, "ground", BodyKind::soil, {0, 0, 0}, {0.4, 0.2, 0});
  add_body(s, "fill", BodyKind::soil, {0, 0.2, 0}, {0.2, 0.3, 0});
  Load road, plate;
  road.name = "road", road.body = "fill", road.traction = {0, -1000, 0};
  plate.name = "plate", plate.kind = Load::Kind::plate, plate.body = "fill";
  plate.plate = {{0, 0.3, 0}, {0.2, 0.3, 0}}, plate.plate_force = Vec3{0, -100, 0};
  s.loads = {road, plate};
  then_remove(s, {"fill"}, 0.05);
  const Recorded r = record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const auto force = r.results.series("plate.plate.force");
  const auto impulse = r.results.series("ledger.impulse_loads", 1);
  EXPECT_EQ(force[4], -100);
  EXPECT_EQ(force.back(), 0);
  EXPECT_NEAR(impulse[5], -(1000 * 0.2 + 100) * 0.05, 1e-6);
  EXPECT_EQ(impulse.back(), impulse[6]);
}

/// The movement of a body that is gone is the last one known.
TEST(Removal, HistoriesKeepWhatTheyKnew) {
  Scene s = plane(0.4, 0.6, 0.05, 0.1);
  add_body(s, "drop", BodyKind::soil, {0.1, 0.3, 0}, {0.3, 0.5, 0});
  add_body(s, "ground", BodyKind::soil, {0, 0, 0}, {0.4, 0.1, 0});
  s.initial.stress = InitialStress::zero;
  s.output.probes = {{"n", {0.2, 0.35, 0}, "porosity"}, {"v", {0.2, 0.35, 0}, "soil_velocity"}};
  then_remove(s, {"drop"}, 0.1);
  const Recorded r = record(s);
  expect_balanced(r.report);
  const auto rise = r.results.series("body.drop.rise");
  EXPECT_LT(rise[9], -0.03);
  EXPECT_EQ(rise.back(), rise[10]);
  EXPECT_NEAR(r.results.series("probe.n")[3], 0.4, 0.05);
  EXPECT_EQ(r.results.last("probe.n"), 1);
  EXPECT_EQ(r.results.last("probe.v", 1), 0);
}

/// Water that passes a reservoir's face when its body goes: the reservoir fills the pool again.
TEST(Removal, AReservoirFillsWhatWasTaken) {
  Scene s = plane(0.2, 0.3, 0.02, 0.2);
  add_body(s, "pool", BodyKind::water, {0, 0, 0}, {0.2, 0.1, 0});
  add_body(s, "more", BodyKind::water, {0, 0.1, 0}, {0.2, 0.2, 0});
  s.water.viscosity = 0.5;
  s.reservoirs = {{"lake", {{0, 0, 0}, {0, 0.3, 0}}, 0.2}};
  s.stages[0].heads = {{"lake", 0.22}};
  Stage& after = then_remove(s, {"pool"}, 6);
  after.heads = {{"lake", 0.2}};
  s.output.frame_interval = 6;
  const Recorded r = record(s);
  expect_balanced(r.report);
  EXPECT_NEAR(r.report.ledger.water_volume, 0.2 * 0.2, 0.05 * 0.04);
}

TEST(Removal, PointsKeepTheirOrder) {
  WaterPoints<2> w;
  for (int p = 0; p < 6; ++p) w.add({1.0 * p, 0}, {}, p, p % 3);
  const auto place = erase_points(w, [&](std::size_t p) { return w.body[p] == 1; });
  EXPECT_EQ(w.mass, (std::vector<double>{0, 2, 3, 5}));
  EXPECT_EQ(w.x[3][0], 5);
  EXPECT_EQ(place, (std::vector<std::uint32_t>{0, kErased, 1, 2, kErased, 3}));
}

}  // namespace
}  // namespace quicksand::test
