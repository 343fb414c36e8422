// The explicit scheme of [FMS19]: the same balance as the implicit one, one step at a time.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "engine/plan/step_bounds.hpp"
#include "engine/step/phases.hpp"
#include "tests/engine/step/motion.hpp"

namespace quicksand {
namespace {

using namespace test;

/// Soft water, so that steps are long enough to see something happen.
constexpr double kBulkModulus = 2e6;  // Pa

Scene with_explicit_pressure(Scene s) {
  s.water.bulk_modulus = kBulkModulus;
  s.numerics.pressure = PressureScheme::explicit_scheme;
  return s;
}

/// Largest stable step of the state's first moment, s, times the usual factor.
template <int D>
double stable_step(const Scene& scene, const State<D>& s) {
  double limit = std::numeric_limits<double>::infinity(), fast_wave = limit;
  for (std::size_t p = 0; p < s.soil.size(); ++p) {
    const StepLimit& l = s.constants.step_limits[s.soil.soil[p]];
    const double n = s.soil.porosity[p];
    const double modulus = s.constants.soils[s.soil.soil[p]].template constrained_modulus<D>({}, n);
    limit = std::min({limit, l.dry(n, modulus), l.saturated(n, modulus)});
    fast_wave = std::min(fast_wave, l.fast_wave(n, modulus));
  }
  return choose_step(scene, {limit, 0, true, fast_wave}).seconds;
}

template <int D>
void expect_rest(const Scene& scene, double level, int steps) {
  State<D> s = make_state<D>(scene);
  const StepReport<D> report = advance_times(s, steps, stable_step(scene, s));
  EXPECT_LT(pressure_error(s, level), 1e-9);
  EXPECT_LT(report.max_speed, 1e-9);
  EXPECT_EQ(report.pressure.unknowns, wet_cells(s));
  EXPECT_EQ(report.pressure.iterations, 0);
}

TEST(ExplicitPressure, StillWaterStaysStillWhereverItsSurfaceIs) {
  for (const int rows : {7, 8}) {  // of half-cell points
    Scene s = with_explicit_pressure(plane(0.5, 0.6, 0.1));
    add_body(s, "pool", BodyKind::water, {0, 0, 0}, {0.5, rows * 0.05, 0});
    expect_rest<2>(s, rows * 0.05, 500);
  }
}

TEST(ExplicitPressure, SandUnderWaterStaysStill) {
  Scene s = with_explicit_pressure(plane(0.3, 0.6, 0.05));
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.3, 0.3, 0});
  add_body(s, "pool", BodyKind::water, {0, 0.3, 0}, {0.3, 0.5, 0});
  State<2> state = make_state<2>(s);
  const StepReport<2> report = advance_times(state, 2000, stable_step(s, state));
  EXPECT_LT(pressure_error(state, 0.5), 1e-3);
  EXPECT_LT(report.max_speed, 1e-4);
}

TEST(ExplicitPressure, StillWaterStaysStillInSpace) {
  Scene s = with_explicit_pressure(space({0.2, 0.3, 0.3}, 0.05));
  add_body(s, "pool", BodyKind::water, {0, 0, 0}, {0.2, 0.2, 0.3});
  expect_rest<3>(s, 0.2, 200);
}

/// The balance that a step leaves behind: with the flux that the velocities carry away, to rounding.
TEST(ExplicitPressure, ChangesByTheDivergenceOfTheFlux) {
  Scene scene = with_explicit_pressure(collapse());
  scene.numerics.drift_time = 0;
  State<2> s = make_state<2>(scene);
  const double dt = stable_step(scene, s);
  advance_times(s, 200, dt);
  points_to_faces(s);
  find_surface(s);
  s.pressure_old = s.pressure;
  predict_velocities(s, dt);
  solve_pressure(s, dt);
  correct_velocities(s);
  double largest_rate = 0, worst = 0;
  for (const int i : s.pressure_system.cell) {
    double divergence = 0;
    for (int d = 0; d < 2; ++d)
      for (int side : {0, 1}) {
        const int face = i + side * s.grid.stride[d];
        if (!s.water_walls.closed(d, face))
          divergence += (2 * side - 1) * s.flow[d][face].flux(s.speeds[d][face]) / s.grid.h;
      }
    const double rate = s.cell[i].n / kBulkModulus * (s.pressure[i] - s.pressure_old[i]) / dt;
    largest_rate = std::max(largest_rate, std::abs(rate));
    worst = std::max(worst, std::abs(rate + divergence));
  }
  EXPECT_GT(largest_rate, 1e-3);
  EXPECT_LT(worst, 1e-9 * largest_rate);
}

/// Sound in a closed box: energy stays bounded just below the bound and grows beyond all bounds above it.
double loudest_after(double of_bound, int steps) {
  Scene scene = with_explicit_pressure(plane(0.8, 0.8, 0.1));
  scene.gravity = {};
  scene.water.viscosity = 0;
  scene.initial.pressure = InitialPressure::zero;
  scene.numerics.pic_rate = 0;
  add_body(scene, "left", BodyKind::water, {0, 0, 0}, {0.4, 0.8, 0});
  add_body(scene, "right", BodyKind::water, {0.4, 0, 0}, {0.8, 0.8, 0});
  scene.bodies[0].velocity = {1e-6, 1e-6, 0};
  State<2> s = make_state<2>(scene);
  double loudest = 0;
  const double dt = of_bound * stable_step(scene, s) / scene.numerics.time_step_factor;
  advance_times(s, steps, dt, [&](const auto& r) { loudest = std::max(loudest, r.max_speed); });
  return loudest;
}

TEST(ExplicitPressure, WaterWaveIsTheStabilityBound) {
  EXPECT_LT(loudest_after(0.98, 2000), 1e-5);
  EXPECT_GT(loudest_after(1.05, 2000), 1e-3);
}

TEST(ExplicitPressure, MomentumLedgerCloses) {
  const Scene scene = with_explicit_pressure(collapse());
  State<2> s = make_state<2>(scene);
  LedgerKeeper<2> keeper(scene, s);
  double worst = 0;
  advance_times(s, 1500, stable_step(scene, s), [&](const auto& r) {
    keeper.add(s, r);
    worst = std::max(worst, keeper.ledger().momentum_residual);
  });
  EXPECT_LT(worst, 2e-11);  // rounding of five times the steps of the implicit scheme's test
  EXPECT_GT(std::abs(keeper.ledger().impulse_walls[0]), 1);
}

TEST(ExplicitPressure, SameBitsOnAnyNumberOfThreads) {
  const Scene scene = with_explicit_pressure(collapse());
  const auto advanced = [&](int threads) {
    State<2> s;
    with_threads(threads, [&] {
      s = make_state<2>(scene);
      advance_times(s, 200, stable_step(scene, s));
    });
    return s;
  };
  const State<2> one = advanced(1), two = advanced(2);
  EXPECT_EQ(one.pressure, two.pressure);
  EXPECT_EQ(one.water.x, two.water.x);
  EXPECT_EQ(one.soil.stress, two.soil.stress);
}

}  // namespace
}  // namespace quicksand
