// Momentum: free fall, the ledger of impulses, mass.

#include <gtest/gtest.h>

#include <numeric>

#include "tests/engine/step/motion.hpp"

namespace quicksand {
namespace {

using namespace test;

double total(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

/// All points of a block that falls 50 steps, out of any wall's reach, move at g t, and it keeps its shape.
template <int D>
void expect_free_fall(const Scene& scene) {
  State<D> s = make_state<D>(scene);
  const double dt = 1e-3, t = 50 * dt, g = s.constants.gravity[kUp];
  advance_times(s, 50, dt);
  const auto check = [&](const auto& set) {
    for (std::size_t p = 0; p < set.size(); ++p)
      for (int d = 0; d < D; ++d) {
        const bool down = d == kUp;
        EXPECT_NEAR(set.v[p][d], down ? g * t : 0, 1e-7);
        // Symplectic Euler: Σ k dt² g.
        EXPECT_NEAR(set.x[p][d] - set.start[p][d], down ? g * dt * dt * 50 * 51 / 2 : 0, 1e-8);
      }
  };
  check(s.soil), check(s.water);
  EXPECT_GT(s.soil.size() + s.water.size(), 0u);
}

TEST(FreeFall, WaterBlock) {
  Scene s = plane(1, 1, 0.1);
  add_body(s, "drop", BodyKind::water, {0.3, 0.4, 0}, {0.7, 0.8, 0});
  s.initial.pressure = InitialPressure::zero;
  s.water.viscosity = 1;
  expect_free_fall<2>(s);
}

TEST(FreeFall, DrySoilBlock) {
  Scene s = plane(1, 1, 0.1);
  add_body(s, "lump", BodyKind::soil, {0.3, 0.4, 0}, {0.7, 0.8, 0});
  s.initial.stress = InitialStress::zero;
  expect_free_fall<2>(s);
}

TEST(FreeFall, SaturatedSoilBlock) {
  Scene s = plane(1, 1, 0.1);
  add_body(s, "lump", BodyKind::saturated_soil, {0.3, 0.4, 0}, {0.7, 0.8, 0});
  s.initial.stress = InitialStress::zero;
  s.initial.pressure = InitialPressure::zero;
  expect_free_fall<2>(s);
}

TEST(FreeFall, WaterBlockInSpace) {
  Scene s = space({0.6, 0.8, 0.6}, 0.1);
  add_body(s, "drop", BodyKind::water, {0.2, 0.3, 0.2}, {0.4, 0.6, 0.4});
  s.initial.pressure = InitialPressure::zero;
  expect_free_fall<3>(s);
}

template <int D>
double ledger_residual(const Scene& scene, int steps, double dt, double least_wall_impulse) {
  State<D> s = make_state<D>(scene);
  LedgerKeeper<D> keeper(scene, s);
  double worst = 0;
  const double water = total(s.water.mass), solid = total(s.soil.mass);
  const std::size_t points = s.water.size() + s.soil.size();
  advance_times(s, steps, dt, [&](const StepReport<D>& r) {
    keeper.add(s, r);
    worst = std::max(worst, keeper.ledger().momentum_residual);
  });
  EXPECT_EQ(total(s.water.mass), water);  // to the bit: points keep their mass
  EXPECT_EQ(total(s.soil.mass), solid);
  EXPECT_EQ(s.water.size() + s.soil.size(), points);
  double wall = 0;
  for (double i : keeper.ledger().impulse_walls) wall = std::max(wall, std::abs(i));
  EXPECT_GE(wall, least_wall_impulse);
  return worst;
}

/// Sand that slides under water, on the given floor.
Scene submerged_bank(double floor) {
  Scene s = plane(1, 1, 0.05);
  s.water.viscosity = 0;
  add_body(s, "bank", BodyKind::saturated_soil, {0, floor, 0}, {0.4, floor + 0.4, 0});
  add_body(s, "beside", BodyKind::water, {0.4, floor, 0}, {1, floor + 0.4, 0});
  add_body(s, "above", BodyKind::water, {0, floor + 0.4, 0}, {1, floor + 0.5, 0});
  return s;
}

constexpr double kClosed = 1e-12;  // of the impulse of weight; rounding

TEST(MomentumLedger, ClosesWhileABankAndAPoolCollapse) {
  EXPECT_LT(ledger_residual<2>(collapse(), 300, 2e-4, 1), kClosed);
}

TEST(MomentumLedger, CountsViscosityAtRoughWalls) {
  Scene s = plane(1, 1, 0.05);
  s.water.viscosity = 10;
  add_body(s, "drop", BodyKind::water, {0.3, 0.2, 0}, {0.7, 0.5, 0});
  s.initial.pressure = InitialPressure::zero;
  for (Side& side : s.domain.sides) side.kind = SideKind::no_slip;
  EXPECT_LT(ledger_residual<2>(s, 400, 5e-4, 10), kClosed);
}

TEST(MomentumLedger, ClosesWhileASubmergedBankSlides) {
  EXPECT_LT(ledger_residual<2>(submerged_bank(0), 300, 2e-4, 1), kClosed);
}

TEST(MomentumLedger, ClosesWhileAPoolCollapses) {
  Scene s = collapse();
  s.water.viscosity = 0;
  s.bodies = {s.bodies[1]};
  EXPECT_LT(ledger_residual<2>(s, 300, 2e-4, 1), kClosed);
}

TEST(MomentumLedger, ClosesWhileADryBankCollapses) {
  Scene s = collapse();
  s.bodies = {s.bodies[2]};
  EXPECT_LT(ledger_residual<2>(s, 300, 2e-4, 1), kClosed);
}

TEST(MomentumLedger, ClosesWhileABlockFallsOntoTheFloor) {
  Scene s = plane(1, 1, 0.05);
  s.water.viscosity = 0;
  add_body(s, "drop", BodyKind::water, {0.3, 0.2, 0}, {0.7, 0.5, 0});
  s.initial.pressure = InitialPressure::zero;
  EXPECT_LT(ledger_residual<2>(s, 400, 1e-3, 100), kClosed);
}

TEST(MomentumLedger, ClosesOverFixedSandAndRoughWalls) {
  Scene s = submerged_bank(0.2);
  add_body(s, "filter", BodyKind::saturated_soil, {0, 0, 0}, {1, 0.2, 0});
  s.bodies.back().fixed = true;
  s.walls = {{"pier", box({0.7, 0.2, 0}, {0.8, 0.4, 0}), {}, true}};
  for (Side& side : s.domain.sides) side.kind = SideKind::no_slip;
  EXPECT_LT(ledger_residual<2>(s, 300, 2e-4, 1), kClosed);
}

TEST(MomentumLedger, ClosesInSpace) {
  Scene s = space({0.6, 0.5, 0.4}, 0.05);
  s.water.viscosity = 0;
  add_body(s, "bank", BodyKind::soil, {0, 0, 0}, {0.2, 0.2, 0.4});
  add_body(s, "pool", BodyKind::water, {0.45, 0, 0}, {0.6, 0.3, 0.4});
  EXPECT_LT(ledger_residual<3>(s, 60, 2e-4, 0.01), kClosed);
}

TEST(MomentumLedger, CountsSurfaceLoads) {
  Scene s = plane(0.6, 0.6, 0.1);
  add_body(s, "bed", BodyKind::soil, {0, 0, 0}, {0.6, 0.3, 0});
  Load load;
  load.name = "fill", load.body = "bed", load.traction = {0, -1000, 0};
  s.loads = {load};
  State<2> state = make_state<2>(s);
  LedgerKeeper<2> keeper(s, state);
  advance_times(state, 100, 2e-4, [&](const auto& r) { keeper.add(state, r); });
  EXPECT_NEAR(keeper.ledger().impulse_loads[1], -1000 * 0.6 * 100 * 2e-4, 1e-9);
  EXPECT_LT(keeper.ledger().momentum_residual, kClosed);
}

/// The area of each side of a block counts; about an axis times the radius of that side.
TEST(MomentumLedger, LoadsActOnTheSideTheyName) {
  const auto push = [](Dimension dimension, BodySide side, const Vec3& traction) {
    Scene s = plane(0.6, 0.6, 0.1);
    s.domain.dimension = dimension;
    s.gravity = {};
    add_body(s, "block", BodyKind::soil, {0.2, 0.2, 0}, {0.4, 0.5, 0});
    Load load;
    load.name = "push", load.body = "block", load.side = side, load.traction = traction;
    s.loads = {load};
    State<2> state = make_state<2>(s);
    return advance_times(state, 1, 1e-4).impulse_loads;
  };
  const auto plane = Dimension::plane_strain, axial = Dimension::axisymmetric;
  EXPECT_NEAR(push(plane, BodySide::left, {1000, 0, 0})[0], 1000 * 0.3 * 1e-4, 1e-12);
  EXPECT_NEAR(push(plane, BodySide::right, {0, 500, 0})[1], 500 * 0.3 * 1e-4, 1e-12);
  EXPECT_NEAR(push(plane, BodySide::bottom, {0, 1000, 0})[1], 1000 * 0.2 * 1e-4, 1e-12);
  EXPECT_NEAR(push(axial, BodySide::right, {0, 1000, 0})[1], 1000 * 0.3 * 0.4 * 1e-4, 1e-12);
  EXPECT_NEAR(push(axial, BodySide::left, {0, 1000, 0})[1], 1000 * 0.3 * 0.2 * 1e-4, 1e-12);
  EXPECT_NEAR(push(axial, BodySide::top, {0, 1000, 0})[1], 1000 * (0.16 - 0.04) / 2 * 1e-4, 1e-12);
}

}  // namespace
}  // namespace quicksand
