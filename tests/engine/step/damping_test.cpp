// Local damping: what it takes, that the ledger holds it, and that it leaves alone what is slow.

#include "engine/step/damping.hpp"

#include <gtest/gtest.h>

#include "tests/engine/step/motion.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand {
namespace {

using namespace test;

constexpr double kMomentumClosed = 1e-12;  // of the impulse of weight; rounding

TEST(Damping, SpeedsUpLessAndSlowsDownMore) {
  EXPECT_DOUBLE_EQ(damped_part(0.7, 1, 0.1), 0.3);
  EXPECT_DOUBLE_EQ(damped_part(0.7, -1, -0.1), 0.3);
  EXPECT_DOUBLE_EQ(damped_part(0.7, 0, 0.1), 0.3);
  EXPECT_DOUBLE_EQ(damped_part(0.7, 1, -0.1), 1.7);
}

/// What would be turned is stopped; only a force that turns it even so, damped, does.
TEST(Damping, StopsAndNeverTurns) {
  for (const double change : {-0.7, -1.0, -2.0, -3.0})
    EXPECT_NEAR(1 + change * damped_part(0.7, 1, change), 0, 1e-15) << change;
  EXPECT_DOUBLE_EQ(damped_part(0.7, 1, -4), 0.3);
}

/// An oscillator dies out at every step that is stable without damping (dt < 2/ω), for any damping.
TEST(Damping, HoldsAtAnyStableStep) {
  for (const double alpha : {0.1, 0.5, 0.8, 0.95})
    for (double turn = 0.5; turn < 2; turn += 0.1) {  // ω dt
      double x = 1, v = 0;
      for (int i = 0; i < 1000; ++i) {
        const double change = -turn * x;
        v += damped_part(alpha, v, change) * change;
        x += turn * v;
      }
      EXPECT_LT(std::abs(x) + std::abs(v), 1e-3) << alpha << " " << turn;
    }
}

/// Away from walls a block falls with (1−α) g; the ledger holds what is missing. Drops at a water surface
/// take their share from it.
TEST(Damping, FallingTakesTheRestOfTheWeight) {
  for (const BodyKind kind : {BodyKind::water, BodyKind::soil, BodyKind::saturated_soil}) {
    const double by_surface = kind == BodyKind::soil ? 1e-6 : 0.1;
    Scene scene = plane(1, 1, 0.1);
    add_body(scene, "lump", kind, {0.3, 0.4, 0}, {0.7, 0.8, 0});
    scene.initial.stress = InitialStress::zero;
    scene.initial.pressure = InitialPressure::zero;
    scene.stages[0].damping = 0.6;
    State<2> s = make_state<2>(scene);
    LedgerKeeper<2> keeper(scene, s);
    double mass = 0;
    advance_times(s, 50, 1e-3, [&](const auto& r) { keeper.add(s, r), mass = r.moving_mass; });
    const double g = 9.81, dt = 1e-3, v = 0.4 * g * 50 * dt;
    for (std::size_t p = 0; p < s.soil.size(); ++p) EXPECT_NEAR(s.soil.v[p][1], -v, 1e-7);
    for (std::size_t p = 0; p < s.water.size(); ++p) EXPECT_NEAR(s.water.v[p][1], -v, 1e-7);
    const Ledger& l = keeper.ledger();
    const double taken = 0.6 * mass * g * 50 * dt;
    EXPECT_NEAR(l.impulse_damping[1] + l.impulse_surface[1], taken, 1e-6 * taken);
    EXPECT_NEAR(l.impulse_damping[1], taken, by_surface * taken);
    EXPECT_LT(l.momentum_residual, kMomentumClosed);
    // Σ ½ m ((v + g dt)² − (v + 0.4 g dt)²) over the steps from v = 0.4 k g dt.
    double energy = 0;
    for (int k = 0; k < 50; ++k)
      energy += 0.5 * mass * std::pow(g * dt, 2) * (std::pow(0.4 * k + 1, 2) - std::pow(0.4 * k + 0.4, 2));
    EXPECT_NEAR(l.energy_damped, energy, by_surface * energy);
  }
}

/// Momentum closed and energy taken, step by step.
template <int D>
void expect_closed(Scene scene, int steps, double dt) {
  scene.stages[0].damping = 0.7;
  State<D> s = make_state<D>(scene);
  LedgerKeeper<D> keeper(scene, s);
  double worst = 0, least = 0;
  advance_times(s, steps, dt, [&](const StepReport<D>& r) {
    keeper.add(s, r);
    worst = std::max(worst, keeper.ledger().momentum_residual);
    least = std::min(least, r.damped);
  });
  const Ledger& l = keeper.ledger();
  EXPECT_LT(worst, kMomentumClosed);
  EXPECT_GT(l.energy_damped, 0);
  EXPECT_GT(least, -1e-3 * l.energy_damped);  // the pressure of the last step may misjudge one face
  double damping = 0;
  for (const double i : l.impulse_damping) damping = std::max(damping, std::abs(i));
  EXPECT_GT(damping, 1e-3);
}

Scene collapse_of_both() {
  Scene s = collapse();
  s.water.viscosity = 0;
  return s;
}

TEST(Damping, LedgerClosesWhileABankAndAPoolCollapse) { expect_closed<2>(collapse_of_both(), 300, 2e-4); }
TEST(Damping, LedgerClosesWithAffineTransfer) {
  Scene s = collapse_of_both();
  s.numerics.transfer = Transfer::apic;
  expect_closed<2>(s, 300, 2e-4);
}
TEST(Damping, LedgerClosesWithLinearKernels) {
  Scene s = collapse_of_both();
  s.numerics.kernel = Kernel::linear;
  expect_closed<2>(s, 300, 1e-4);
}
TEST(Damping, LedgerClosesAboutAnAxis) {
  Scene s = collapse_of_both();
  s.domain.dimension = Dimension::axisymmetric;
  expect_closed<2>(s, 300, 2e-4);
}
TEST(Damping, LedgerClosesWithExplicitPressure) {
  Scene s = collapse_of_both();
  s.water.bulk_modulus = 2e6;
  s.numerics.pressure = PressureScheme::explicit_scheme;
  expect_closed<2>(s, 600, 1e-4);
}
TEST(Damping, LedgerClosesOverFixedSand) {
  Scene s = plane(1, 1, 0.05);
  add_body(s, "filter", BodyKind::saturated_soil, {0, 0, 0}, {1, 0.2, 0});
  s.bodies.back().fixed = true;
  add_body(s, "bank", BodyKind::saturated_soil, {0, 0.2, 0}, {0.4, 0.6, 0});
  add_body(s, "pool", BodyKind::water, {0.4, 0.2, 0}, {1, 0.5, 0});
  for (Side& side : s.domain.sides) side.kind = SideKind::no_slip;
  expect_closed<2>(s, 300, 2e-4);
}
TEST(Damping, LedgerClosesInSpace) {
  Scene s = space({0.6, 0.5, 0.4}, 0.05);
  s.water.viscosity = 0;
  add_body(s, "bank", BodyKind::soil, {0, 0, 0}, {0.2, 0.2, 0.4});
  add_body(s, "pool", BodyKind::water, {0.45, 0, 0}, {0.6, 0.3, 0.4});
  expect_closed<3>(s, 60, 2e-4);
}

TEST(Damping, LedgerClosesUnderAPlate) {
  Scene s = plane(0.4, 0.5, 0.05, 0.05);
  s.gravity = {};
  s.initial.stress = InitialStress::zero;
  add_body(s, "bed", BodyKind::soil, {0, 0, 0}, {0.4, 0.3, 0});
  Load load;
  load.kind = Load::Kind::plate, load.name = "plate", load.body = "bed";
  load.plate = {{0, 0.3, 0}, {0.2, 0.3, 0}};
  load.plate_force = Vec3{0, -500, 0};
  s.loads = {load};
  s.stages[0].damping = 0.7;
  const Recorded r = record(s);
  EXPECT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  EXPECT_LT(r.report.ledger.momentum_residual, 1e-10);
  EXPECT_GT(r.report.ledger.energy_damped, 0);
}

/// Flow between two reservoirs through sand whose grains may move: out of balance is next to nothing.
TEST(Damping, LeavesSteadySeepageAlone) {
  const auto flow = [](double damping) {
    Scene s = plane(0.04, 0.24, 0.02, 0.5);
    add_body(s, "sand", BodyKind::saturated_soil, {0, 0, 0}, {0.04, 0.2, 0});
    s.soils["sand"].permeability = {.law = PermeabilityLaw::constant, .value = 1e-3};
    s.reservoirs = {{"below", {{0, 0, 0}, {0.04, 0, 0}}, 0.26},
                    {"side", {{0.04, 0.16, 0}, {0.04, 0.24, 0}}, 0.2}};
    s.output.sections = {{"middle", {{0, 0.1, 0}, {0.04, 0.1, 0}}, "flow"}};
    s.stages[0].damping = damping;
    const Recorded r = record(s);
    EXPECT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
    return r.results.last("section.middle");
  };
  const double free = flow(0);
  EXPECT_NEAR(free, 1.3e-5, 1e-6);
  EXPECT_NEAR(flow(0.8), free, 2e-3 * free);
}

/// Excess pressure of a loaded column at T ≈ 0.1 and 0.3.
TEST(Damping, LeavesConsolidationAlone) {
  const auto pressure = [](double damping) {
    Scene s = plane(0.1, 1, 0.05, 0.6);
    s.gravity = {};
    add_body(s, "clay", BodyKind::saturated_soil, {0, 0, 0}, {0.1, 1, 0});
    s.soils["sand"].permeability = {.law = PermeabilityLaw::constant, .value = 3e-4};
    s.soils["sand"].model = {.law = SoilLaw::linear_elastic, .young_modulus = 1e7, .poisson_ratio = 0.3};
    s.initial.stress = InitialStress::zero;
    Load load;
    load.name = "fill", load.body = "clay", load.traction = {0, -1e4, 0};
    s.loads = {load};
    s.output.probes = {{"base", {0.05, 0, 0}, "pore_pressure"}};
    s.output.series_interval = 0.2;
    s.stages[0].damping = damping;
    return record(s).results.series("probe.base");
  };
  const auto free = pressure(0), damped = pressure(0.8);
  ASSERT_EQ(free.size(), 4u);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_GT(free[i], 2e3);
    EXPECT_NEAR(damped[i], free[i], 20) << i;  // of 10 kPa
  }
}

}  // namespace
}  // namespace quicksand
