// Kernels and transfers by name: what each of them keeps.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/step/phases.hpp"
#include "engine/step/scheme.hpp"
#include "tests/engine/step/motion.hpp"

namespace quicksand {
namespace {

using namespace test;

struct Choice {
  Kernel kernel;
  Transfer transfer;
};
constexpr Choice kAll[] = {{Kernel::quadratic, Transfer::flip},
                           {Kernel::quadratic, Transfer::apic},
                           {Kernel::linear, Transfer::flip},
                           {Kernel::linear, Transfer::apic}};

Scene with(Scene s, const Choice& c) {
  s.numerics.kernel = c.kernel, s.numerics.transfer = c.transfer;
  return s;
}

std::string name(const Choice& c) {
  return std::string(c.kernel == Kernel::linear ? "linear " : "quadratic ") +
         (c.transfer == Transfer::apic ? "apic" : "flip");
}

Scene elastic_block(double h = 0.1) {
  Scene s = plane(2, 2, h);
  s.gravity = {};
  s.initial.stress = InitialStress::zero;
  add_body(s, "block", BodyKind::soil, {0.7, 0.7, 0}, {1.3, 1.1, 0});
  s.soils["sand"].model = {.law = SoilLaw::linear_elastic, .young_modulus = 1e6, .poisson_ratio = 0.3};
  return s;
}

/// Points spin about `center` at `rate` rad/s, the velocity's gradient with them.
template <class Set>
void spin(Set& set, const Vec<2>& center, double rate) {
  for (std::size_t p = 0; p < set.size(); ++p) {
    set.v[p] = {-rate * (set.x[p][1] - center[1]), rate * (set.x[p][0] - center[0])};
    if (!set.affine.empty()) set.affine[p] = {Vec<2>{0, -rate}, Vec<2>{rate, 0}};
  }
}

/// Σ m x × v, and what the gradient of each point's velocity holds: m (D c_yx − D c_xy) with the kernel's
/// second moments D (m²) on the faces of each component.
template <class Set>
double angular_momentum(const State<2>& s, const Walls<2>& walls, const Set& set) {
  double sum = 0;
  with_kernel(s.constants.kernel, [&](auto shape) {
    for (std::size_t p = 0; p < set.size(); ++p) {
      sum += set.mass[p] * (set.x[p][0] * set.v[p][1] - set.x[p][1] * set.v[p][0]);
      if (set.affine.empty()) continue;
      const PointKernel<2, decltype(shape)> kernel(s.grid, set.x[p]);
      for (int d = 0; d < 2; ++d) {
        double moment = 0;
        for_faces(s.grid, walls, kernel, d,
                  [&](int, const FaceWeight<2>& f, double) { moment += f.w * f.arm[1 - d] * f.arm[1 - d]; });
        sum += (d == 1 ? 1 : -1) * set.mass[p] * moment * set.affine[p][d][1 - d];
      }
    }
  });
  return sum;
}

/// Largest change of the block's angular momentum over 200 steps, relative.
double spin_lost(const Choice& choice) {
  State<2> s = make_state<2>(with(elastic_block(), choice));
  std::mt19937 random(3);  // anywhere in its cell
  std::uniform_real_distribution<double> jitter(-0.02, 0.02);
  for (auto& x : s.soil.x) x[0] += jitter(random), x[1] += jitter(random);
  spin(s.soil, {1, 0.9}, 3);
  const double start = angular_momentum(s, s.soil_walls, s.soil);
  double worst = 0;
  advance_times(s, 200, 5e-4, [&](const auto&) {
    worst = std::max(worst, std::abs(angular_momentum(s, s.soil_walls, s.soil) / start - 1));
  });
  return worst;
}

/// With quadratic splines to the mass cut-off of 1e-10 of a face. The moments of hats change as a point moves
/// through its cell, and light faces hand on their force: they keep it to a per cent.
TEST(Transfer, ApicKeepsTheAngularMomentumOfASpinningBlock) {
  EXPECT_LT(spin_lost({Kernel::quadratic, Transfer::apic}), 1e-9);
  EXPECT_LT(spin_lost({Kernel::linear, Transfer::apic}), 0.02);
  EXPECT_GT(spin_lost({Kernel::quadratic, Transfer::flip}), 1e-6);  // the balance above is no identity
}

/// To the grid and back, of drops too thin to have pressure: both kernels to rounding and the mass cut-off.
TEST(Transfer, ApicKeepsTheAngularMomentumOfDrops) {
  for (const Kernel kernel : {Kernel::quadratic, Kernel::linear}) {
    Scene scene = with(plane(2, 2, 0.1), {kernel, Transfer::apic});
    scene.gravity = {};
    scene.water.viscosity = 0;
    add_body(scene, "mist", BodyKind::water, {0.7, 0.7, 0}, {1.3, 1.1, 0});
    State<2> s = make_state<2>(scene);
    for (double& m : s.water.mass) m *= 0.3;
    spin(s.water, {1, 0.9}, 3);
    const double start = angular_momentum(s, s.water_walls, s.water);
    const double dt = kernel == Kernel::linear ? 1e-12 : 1e-3;  // hats: before the points move
    const auto report = advance_times(s, 100, dt);
    EXPECT_EQ(report.pressure.unknowns, 0);
    EXPECT_NEAR(angular_momentum(s, s.water_walls, s.water) / start, 1, 1e-9);
  }
}

/// Rigid motion is a linear field: the gradient carries it, so that one step changes no velocity of a
/// spinning block. Stress comes with the second step.
TEST(Transfer, RigidSpinPassesUnchanged) {
  for (const Choice& choice : kAll) {
    State<2> s = make_state<2>(with(elastic_block(), choice));
    spin(s.soil, {1, 0.9}, 3);
    const auto before = s.soil.v;
    advance(s, 1e-6);
    double worst = 0;
    for (std::size_t p = 0; p < s.soil.size(); ++p)
      for (int d = 0; d < 2; ++d) worst = std::max(worst, std::abs(s.soil.v[p][d] - before[s.soil.id[p]][d]));
    EXPECT_LT(worst, choice.transfer == Transfer::apic ? 1e-12 : 3e-5) << name(choice);
  }
}

TEST(Transfer, MomentumLedgerClosesWithAll) {
  for (const Choice& choice : kAll) {
    const Scene scene = with(collapse(), choice);
    State<2> s = make_state<2>(scene);
    LedgerKeeper<2> keeper(scene, s);
    double worst = 0;
    advance_times(s, 300, 2e-4, [&](const auto& r) {
      ASSERT_TRUE(r.finite);
      keeper.add(s, r);
      worst = std::max(worst, keeper.ledger().momentum_residual);
    });
    EXPECT_LT(worst, 1e-12) << name(choice);
  }
}

TEST(Transfer, StillWaterStaysStillWithAll) {
  for (const Choice& choice : kAll)
    for (const int rows : {7, 8}) {  // of half-cell points
      Scene scene = with(plane(0.5, 0.6, 0.1), choice);
      add_body(scene, "pool", BodyKind::water, {0, 0, 0}, {0.5, rows * 0.05, 0});
      State<2> s = make_state<2>(scene);
      const auto report = advance_times(s, 200, 2e-3);
      EXPECT_LT(pressure_error(s, rows * 0.05), 1e-6) << name(choice);
      EXPECT_LT(report.max_speed, 1e-9) << name(choice);
    }
}

TEST(Transfer, AllFallFreely) {
  for (const Choice& choice : kAll) {
    Scene scene = with(elastic_block(), choice);
    scene.gravity = {0, -9.81, 0};
    State<2> s = make_state<2>(scene);
    advance_times(s, 200, 1e-3);
    for (std::size_t p = 0; p < s.soil.size(); ++p) {
      EXPECT_NEAR(s.soil.v[p][0], 0, 1e-12) << name(choice);
      EXPECT_NEAR(s.soil.v[p][1], -9.81 * 0.2, 1e-12) << name(choice);
      for (double c : s.soil.stress[p]) EXPECT_NEAR(c, 0, 1e-6) << name(choice);  // Pa, E = 1 MPa
    }
  }
}

/// Hats: as the block moves over the lattice its last points are now far into a cell, now just inside it.
/// Without light faces the step would have no bound to keep (see light_faces.cpp).
TEST(LinearKernel, VibratingBlockIsStableAtItsBoundWhereverItIs) {
  Scene scene = with(elastic_block(), {Kernel::linear, Transfer::flip});
  scene.numerics.pic_rate = 0;
  scene.bodies[0].velocity = {0.5, 0.3, 0};
  State<2> s = make_state<2>(scene);
  const double limit = s.constants.step_limits[0].dry(0.4, 1.346e6);
  EXPECT_NEAR(limit, 2 * std::sqrt(0.1) * 0.1 / std::sqrt(1.346e6 / (0.6 * 2650)), 0.01 * limit);
  for (std::size_t p = 0; p < s.soil.size(); ++p) s.soil.v[p][0] += 0.1 * (s.soil.x[p][0] - 1);
  StepReport<2> start;
  measure_motion(s, start);
  const double moving = 0.5 * start.moving_mass * (0.5 * 0.5 + 0.3 * 0.3);  // J, of the block as a whole
  double largest = 0;
  advance_times(s, 450, 0.98 * limit,  // until it has moved by four and a half cells
                [&](const auto& r) { largest = std::max(largest, r.kinetic + strain_energy(s)); });
  EXPECT_GT(start.kinetic, moving);
  EXPECT_LT(largest - moving, 1.2 * (start.kinetic - moving));  // hats that points cross are rough: 1.15
}

TEST(LinearKernel, LightFacesMoveWithTheirNeighbours) {
  Scene scene = with(elastic_block(), {Kernel::linear, Transfer::flip});
  State<2> s = make_state<2>(scene);
  for (auto& x : s.soil.x) x[0] += 0.0255;  // the outer column of points just over the next cell's side
  const double mass = 0.6 * 2650 * 0.6 * 0.4;
  advance(s, 1e-5);
  int light = 0;
  double sum = 0;
  for (int face = 0; face < s.grid.count(); ++face) {
    sum += s.sums[0][face].soil_mass;
    if (s.follower[0][face].leader == 0) continue;
    ++light;
    const FaceSpeeds &f = s.speeds[0][face], &leader = s.speeds[0][leader_of(s, 0, face)];
    EXPECT_EQ(s.sums[0][face].soil_mass, 0);
    EXPECT_EQ(f.soil, f.soil_old + leader.soil - leader.soil_old);
  }
  EXPECT_GT(light, 3);
  EXPECT_NEAR(sum / mass, 1, 1e-12);
}

/// What a scene does not use is not there.
TEST(Transfer, GradientsAndLeadersOnlyWhereAskedFor) {
  const State<2> plain = make_state<2>(collapse());
  EXPECT_TRUE(plain.soil.affine.empty() && plain.water.affine.empty() && plain.follower[0].empty());
  const State<2> apic = make_state<2>(with(collapse(), {Kernel::linear, Transfer::apic}));
  EXPECT_EQ(apic.soil.affine.size(), apic.soil.size());
  EXPECT_EQ(apic.water.affine.size(), apic.water.size());
  EXPECT_FALSE(apic.follower[0].empty());
}

}  // namespace
}  // namespace quicksand
