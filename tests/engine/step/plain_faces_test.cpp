// Faces several at a time against the same equations face by face.

#include <gtest/gtest.h>

#include <cmath>

#include "engine/step/phases.hpp"
#include "engine/step/pressure.hpp"
#include "tests/engine/step/motion.hpp"

namespace quicksand {
namespace {

using namespace test;

/// Velocities at the end of a step and what supports do in it, before points move.
template <int D>
struct Solved {
  State<D> s;
  Supports<D> supports;
  long plain = 0;
};

template <int D>
Solved<D> solved(const State<D>& before, bool together, double dt) {
  Solved<D> out{before, {}, 0};
  State<D>& s = out.s;
  points_to_faces(s);
  find_surface(s);
  if (together) find_plain_blocks(s);
  for (const std::uint8_t plain : s.plain) out.plain += plain;
  s.pressure_old = s.pressure;
  predict_velocities(s, dt);
  if (s.has_water) solve_pressure(s, dt);
  correct_velocities(s);
  out.supports = support_impulses(s, dt, 0.1);
  return out;
}

template <int D>
void expect_agreement(const Scene& scene, double dt) {
  State<D> before = make_state<D>(scene);
  advance_times(before, 20, dt);
  const Solved<D> one = solved(before, false, dt), some = solved(before, true, dt);
  ASSERT_EQ(one.plain, 0);
  ASSERT_GT(some.plain, 0);
  double speed = 0, exchange = 0, impulse = 0;
  for (int d = 0; d < D; ++d) {
    for (const FaceSpeeds& v : one.s.speeds[d])
      speed = std::max({speed, std::abs(v.soil), std::abs(v.water)});
    for (const FaceFlow& f : one.s.flow[d]) exchange = std::max(exchange, std::abs(f.exchange));
    impulse = std::max(impulse, std::abs(one.supports.walls[d]));
  }
  ASSERT_GT(speed, 1e-4);
  const double bound = 1e-9;
  long differ = 0;
  for (int d = 0; d < D; ++d) {
    for (int i = 0; i < before.grid.count(); ++i) {
      const FaceSpeeds &a = one.s.speeds[d][i], &b = some.s.speeds[d][i];
      for (const double by :
           {a.soil - b.soil, a.water - b.water, a.soil_old - b.soil_old, a.water_old - b.water_old})
        differ += !(std::abs(by) <= bound * speed);
      if (!before.keeps_flow()) continue;
      const FaceFlow &f = one.s.flow[d][i], &g = some.s.flow[d][i];
      EXPECT_EQ(f.wet, g.wet);
      differ += !(std::abs(f.phi - g.phi) + std::abs(f.n - g.n) <= bound);
      differ += !(std::abs(f.soil_response - g.soil_response) <= bound * std::abs(f.soil_response));
      differ += !(std::abs(f.water_response - g.water_response) <= bound * std::abs(f.water_response));
      differ += !(std::abs(f.exchange - g.exchange) <= 1e-6 * exchange);
      differ += !(std::abs(f.viscous - g.viscous) <= bound * speed / dt);
    }
    EXPECT_NEAR(one.supports.walls[d], some.supports.walls[d], bound * impulse);
  }
  EXPECT_EQ(differ, 0);
}

/// Wide and deep enough that blocks lie out of reach of all walls and of the surface.
Scene sand_under_water() {
  Scene s = plane(1, 1, 0.025);
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.5, 0.6, 0});
  add_body(s, "beside", BodyKind::water, {0.5, 0, 0}, {1, 0.6, 0});
  add_body(s, "pond", BodyKind::water, {0, 0.6, 0}, {1, 0.8, 0});
  return s;
}

TEST(PlainFaces, OfSandUnderWater) {
  Scene s = sand_under_water();
  s.water.viscosity = 0.5;
  expect_agreement<2>(s, 2e-4);
}

TEST(PlainFaces, WithThePressureExplicit) {
  Scene s = sand_under_water();
  s.water.bulk_modulus = 1e6;
  s.numerics.pressure = PressureScheme::explicit_scheme;
  expect_agreement<2>(s, 5e-5);
}

TEST(PlainFaces, OfWaterAlone) {
  Scene s = plane(1, 1, 0.025);
  s.water.viscosity = 0.1;
  add_body(s, "pool", BodyKind::water, {0, 0, 0}, {0.6, 0.7, 0});
  expect_agreement<2>(s, 5e-4);
}

TEST(PlainFaces, OfDrySand) {
  Scene s = plane(1, 1, 0.025);
  add_body(s, "column", BodyKind::soil, {0, 0, 0}, {0.6, 0.7, 0});
  expect_agreement<2>(s, 1e-4);
}

TEST(PlainFaces, InSpace) {
  Scene s = space({0.8, 0.9, 0.8}, 0.05);
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.4, 0.6, 0.8});
  add_body(s, "beside", BodyKind::water, {0.4, 0, 0}, {0.8, 0.7, 0.8});
  expect_agreement<3>(s, 2e-4);
}

TEST(PlainFaces, NoneWhereAllIsFixedOrDamped) {
  Scene s = plane(1, 1, 0.025);
  add_body(s, "pool", BodyKind::water, {0, 0, 0}, {1, 0.7, 0});
  State<2> state = make_state<2>(s);
  state.constants.damping = 0.5;
  points_to_faces(state);
  find_surface(state);
  find_plain_blocks(state);
  for (const std::uint8_t plain : state.plain) EXPECT_EQ(plain, 0);
}

}  // namespace
}  // namespace quicksand
