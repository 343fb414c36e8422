// What is at rest stays at rest.

#include <gtest/gtest.h>

#include "tests/engine/step/motion.hpp"

namespace quicksand {
namespace {

using namespace test;

constexpr double kStill = 1e-6;          // m/s
constexpr double kPressureError = 1e-3;  // of ρw g × depth

template <int D>
void expect_rest(const Scene& scene, double level, double dt, int wet) {
  State<D> s = make_state<D>(scene);
  double fastest = 0;
  const auto last = advance_times(s, 200, dt, [&](const auto& r) {
    fastest = std::max(fastest, r.max_speed);
    ASSERT_TRUE(r.pressure.converged);
  });
  EXPECT_LT(fastest, kStill);
  EXPECT_LT(pressure_error(s, level), kPressureError);
  EXPECT_EQ(wet_cells(s), wet);
  EXPECT_EQ(s.interventions.clipped_points, 0);
  EXPECT_EQ(s.interventions.cut_steps, 0);
  EXPECT_TRUE(last.finite);
}

TEST(Rest, TankOfWater) {
  Scene s = plane(1, 1, 0.1);
  add_body(s, "pool", BodyKind::water, {0, 0, 0}, {1, 0.6, 0});
  expect_rest<2>(s, 0.6, 5e-3, 60);
}

TEST(Rest, SurfaceWithinACell) {
  Scene s = plane(1, 1, 0.1);
  add_body(s, "pool", BodyKind::water, {0, 0, 0}, {1, 0.55, 0});
  State<2> state = make_state<2>(s);
  double fastest = 0;
  advance_times(state, 200, 5e-3, [&](const auto& r) { fastest = std::max(fastest, r.max_speed); });
  EXPECT_LT(fastest, kStill);
  EXPECT_LT(pressure_error(state, 0.55), kPressureError);
}

TEST(Rest, TankOfWaterInSpace) {
  Scene s = space({0.4, 0.6, 0.3}, 0.1);
  add_body(s, "pool", BodyKind::water, {0, 0, 0}, {0.4, 0.4, 0.3});
  expect_rest<3>(s, 0.4, 5e-3, 4 * 3 * 4);
}

TEST(Rest, ClosedTankWithoutAFreeSurface) {
  Scene s = plane(0.5, 0.5, 0.1);
  add_body(s, "all", BodyKind::water, {0, 0, 0}, {0.5, 0.5, 0});
  expect_rest<2>(s, 0.5, 5e-3, 25);
}

TEST(Rest, ClosedTankOfIncompressibleWater) {  // pressure is known but for a constant
  Scene s = plane(0.5, 0.5, 0.1);
  add_body(s, "all", BodyKind::water, {0, 0, 0}, {0.5, 0.5, 0});
  s.water.bulk_modulus.reset();
  expect_rest<2>(s, 0.5, 5e-3, 25);
}

/// Weight of grains is balanced by points' stresses to the accuracy of the lattice; what is left swings out
/// slowly and far below what could be seen.
template <int D>
void expect_settles(Scene scene, double level, int steps) {
  scene.soils["sand"].permeability.value = 1e-2;
  State<D> s = make_state<D>(scene);
  double fastest = 0, furthest = 0;
  const auto last =
      advance_times(s, steps, 2.5e-4, [&](const auto& r) { fastest = std::max(fastest, r.max_speed); });
  for (std::size_t p = 0; p < s.soil.size(); ++p)
    for (int d = 0; d < D; ++d) furthest = std::max(furthest, std::abs(s.soil.x[p][d] - s.soil.start[p][d]));
  EXPECT_LT(fastest, 1e-3);
  EXPECT_LT(last.max_speed, kStill);
  EXPECT_LT(furthest, 5e-5);  // m; the layer is some decimetres thick
  EXPECT_LT(pressure_error(s, level), kPressureError);
}

TEST(Rest, SandUnderWaterSettlesUnseen) {
  Scene s = plane(0.6, 1, 0.1);
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.6, 0.4, 0});
  add_body(s, "pool", BodyKind::water, {0, 0.4, 0}, {0.6, 0.7, 0});
  expect_settles<2>(s, 0.7, 2000);
}

TEST(Rest, SandUnderWaterSettlesUnseenInSpace) {
  Scene s = space({0.2, 0.6, 0.2}, 0.1);
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.2, 0.2, 0.2});
  add_body(s, "pool", BodyKind::water, {0, 0.2, 0}, {0.2, 0.4, 0.2});
  expect_settles<3>(s, 0.4, 2000);
}

TEST(Rest, TanksOfDifferentLevelsOnEitherSideOfAWall) {
  Scene s = plane(1, 1, 0.1);
  add_body(s, "left", BodyKind::water, {0, 0, 0}, {0.5, 0.8, 0});
  add_body(s, "right", BodyKind::water, {0.5, 0, 0}, {1, 0.3, 0});
  s.gates = {{"gate", {{0.5, 0, 0}, {0.5, 1, 0}}}};
  State<2> state = make_state<2>(s);
  double fastest = 0;
  advance_times(state, 200, 5e-3, [&](const auto& r) { fastest = std::max(fastest, r.max_speed); });
  EXPECT_LT(fastest, kStill);
  Stage open = s.stages[0];
  open.open_gates = {"gate"};
  enter_stage(s, open, state);
  advance_times(state, 20, 5e-3);
  double sideways = 0;
  for (std::size_t p = 0; p < state.water.size(); ++p)
    if (std::abs(state.water.x[p][0] - 0.5) < 0.1) sideways = std::max(sideways, state.water.v[p][0]);
  EXPECT_GT(sideways, 0.1);  // and it flows to the right once the gate is open
}

TEST(Rest, StillWaterKeepsItsPressureInFixedSand) {
  Scene s = plane(0.6, 1, 0.1);
  add_body(s, "filter", BodyKind::saturated_soil, {0, 0, 0}, {0.6, 0.2, 0});
  s.bodies.back().fixed = true;
  add_body(s, "pool", BodyKind::water, {0, 0.2, 0}, {0.6, 0.6, 0});
  expect_rest<2>(s, 0.6, 5e-3, 36);
}

}  // namespace
}  // namespace quicksand
