// About an axis: x is the radius, everything is per radian.

#include <gtest/gtest.h>

#include "engine/run/sampling.hpp"
#include "engine/scene/check.hpp"
#include "engine/step/phases.hpp"
#include "tests/engine/step/motion.hpp"

namespace quicksand {
namespace {

using namespace test;

Scene axial(double radius, double height, double h, double inner = 0) {
  Scene s = plane(radius, height, h);
  s.domain.dimension = Dimension::axisymmetric;
  s.domain.min[0] = inner;
  return s;
}

/// Ground that fills everything around a block and a thin wall.
Scene filled(double inner) {
  Scene s = axial(inner + 1, 1, 0.1, inner);
  add_body(s, "left", BodyKind::saturated_soil, {inner, 0, 0}, {inner + 0.4, 1, 0});
  add_body(s, "right", BodyKind::saturated_soil, {inner + 0.6, 0, 0}, {inner + 1, 1, 0});
  add_body(s, "above", BodyKind::saturated_soil, {inner + 0.4, 0.5, 0}, {inner + 0.6, 1, 0});
  s.walls = {{"pier", box({inner + 0.4, 0, 0}, {inner + 0.6, 0.5, 0}), {}, false},
             {"pile", {}, Segment{{inner + 0.8, 0.3, 0}, {inner + 0.8, 0.7, 0}}, false}};
  return s;
}

/// A uniform filling reads as uniform at every cell and every face, beside the axis and beside walls.
TEST(Axial, UniformGroundIsUniformEverywhere) {
  for (const double inner : {0.0, 0.3}) {
    const Scene scene = filled(inner);
    ASSERT_TRUE(check(scene).empty()) << check(scene)[0].pointer << check(scene)[0].detail;
    const State<2> s = make_state<2>(scene);
    int cells = 0, faces = 0;
    for_each_cell(s.grid, [&](int i, const Cell<2>&) {
      if (s.water_walls.blocked(i)) return;
      ++cells;
      EXPECT_NEAR(s.cell[i].n, 0.4, 1e-12);
      EXPECT_NEAR(s.cell[i].fill, 1, 1e-12);
      for (int d = 0; d < 2; ++d) {
        if (s.water_walls.closed(d, i)) continue;
        ++faces;
        EXPECT_NEAR(s.sums[d][i].grains / s.volume.face(d, i), 0.6, 1e-12);
        EXPECT_NEAR(s.sums[d][i].water_mass / s.volume.face(d, i), 400, 1e-9);
      }
    });
    EXPECT_EQ(cells, 90);
    EXPECT_GT(faces, 100);
  }
}

/// Away from walls a kernel holds h² times its radius.
TEST(Axial, KernelVolumesGoWithTheRadius) {
  const State<2> s = make_state<2>(filled(0));
  const int i = s.grid.index({2, 7});
  EXPECT_NEAR(s.volume.cell(i), 0.01 * 0.25, 1e-15);
  EXPECT_NEAR(s.volume.face(0, i), 0.01 * 0.2, 1e-15);
  EXPECT_NEAR(s.volume.face(1, i), 0.01 * 0.25, 1e-15);
}

TEST(Axial, PlaneStoresNoVolumes) {
  Scene scene = filled(0);
  scene.domain.dimension = Dimension::plane_strain;
  const State<2> s = make_state<2>(scene);
  EXPECT_TRUE(s.volume.of_cell.empty());
  EXPECT_EQ(s.volume.cell(s.grid.index({2, 7})), s.grid.cell_volume());
  EXPECT_EQ(s.grid.face_radius(0, s.grid.index({2, 7})), 1);
}

TEST(Axial, MassIsPerRadian) {
  Scene scene = axial(1, 1, 0.1, 0.2);
  add_body(scene, "ring", BodyKind::water, {0.5, 0, 0}, {0.8, 0.4, 0});
  const State<2> s = make_state<2>(scene);
  double mass = 0;
  for (double m : s.water.mass) mass += m;
  EXPECT_NEAR(mass, 1000 * 0.4 * (0.64 - 0.25) / 2, 1e-9);
  scene.bodies[0].region = box({0.2, 0, 0}, {1, 0.4, 0});
  EXPECT_NEAR(water_volume(make_state<2>(scene)), 0.4 * (1 - 0.04) / 2, 1e-12);
}

void expect_still(const Scene& scene, double level, double dt, int steps, double speed) {
  ASSERT_TRUE(check(scene).empty());
  State<2> s = make_state<2>(scene);
  LedgerKeeper<2> keeper(scene, s);
  double fastest = 0;
  advance_times(s, steps, dt, [&](const auto& r) {
    keeper.add(s, r);
    fastest = std::max(fastest, r.max_speed);
  });
  EXPECT_LT(fastest, speed);
  EXPECT_LT(pressure_error(s, level), 1e-3);
  EXPECT_LT(keeper.ledger().momentum_residual, 1e-12);
  EXPECT_EQ(s.interventions.clipped_points, 0);
}

TEST(Axial, TankStaysAtRest) {
  for (const double inner : {0.0, 0.3}) {
    Scene s = axial(inner + 1, 1, 0.1, inner);
    s.walls = {{"pier", box({inner + 0.4, 0, 0}, {inner + 0.6, 0.3, 0}), {}, false}};
    add_body(s, "left", BodyKind::water, {inner, 0, 0}, {inner + 0.4, 0.6, 0});
    add_body(s, "above", BodyKind::water, {inner + 0.4, 0.3, 0}, {inner + 0.6, 0.6, 0});
    add_body(s, "right", BodyKind::water, {inner + 0.6, 0, 0}, {inner + 1, 0.6, 0});
    expect_still(s, 0.6, 5e-3, 200, 1e-6);
  }
}

TEST(Axial, SandUnderWaterStaysAtRest) {
  Scene s = axial(0.6, 1, 0.1);
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.6, 0.4, 0});
  add_body(s, "pool", BodyKind::water, {0, 0.4, 0}, {0.6, 0.7, 0});
  s.soils["sand"].permeability.value = 1e-2;
  expect_still(s, 0.7, 2.5e-4, 1000, 1e-3);
}

/// v_r = a r, v_z = b z: strain rates a, a and b. Faces weigh velocities with the mass per radian, which
/// adds a h²/4r to v_r; far from the axis that is nothing.
TEST(Axial, UniformExpansionIsUniformStrain) {
  Scene scene = axial(11, 1, 0.1, 10);
  scene.gravity = {};
  add_body(scene, "ring", BodyKind::soil, {10.1, 0, 0}, {10.9, 0.8, 0});
  scene.soils["sand"].model.law = SoilLaw::linear_elastic;
  scene.initial.stress = InitialStress::zero;
  State<2> s = make_state<2>(scene);
  constexpr double kRadial = 0.3, kUpward = -0.2, kDt = 1e-5;
  for (std::size_t p = 0; p < s.soil.size(); ++p)
    s.soil.v[p] = {kRadial * s.soil.x[p][0], kUpward * s.soil.x[p][1]};
  advance(s, kDt);
  const Elastic e = Elastic::from_young(1e7, 0.3);
  const double mean = e.lame() * (2 * kRadial + kUpward) * kDt;
  int inside = 0;
  for (std::size_t p = 0; p < s.soil.size(); ++p) {
    // Out of the reach of the ring's free edges.
    if (std::abs(s.soil.start[p][0] - 10.5) > 0.1 || s.soil.start[p][1] > 0.5) continue;
    ++inside;
    const Stress<2>& t = s.soil.stress[p];
    EXPECT_NEAR(t[0], mean + 2 * e.shear * kRadial * kDt, 0.01);  // Pa, of some 50
    EXPECT_NEAR(t[1], mean + 2 * e.shear * kUpward * kDt, 0.01);
    EXPECT_NEAR(t[2], mean + 2 * e.shear * kRadial * kDt, 0.01);
    EXPECT_NEAR(t[3], 0, 0.01);
    EXPECT_NEAR(1 - s.soil.porosity[p], 0.6 / (1 + kDt * (2 * kRadial + kUpward)), 1e-9);
  }
  EXPECT_EQ(inside, 40);
}

/// The same pressure on all grains is in balance, but for the sum over points that stands for ∫ (r w)′ dr:
/// beside the axis it is off by (spacing/h)²/12 of the stress at r = h, 2 % with two points per cell;
/// stresses there adjust by 3 %.
TEST(Axial, UniformPressureOfTheGrainsPushesNowhere) {
  Scene scene = axial(1, 1, 0.1);
  scene.gravity = {};
  add_body(scene, "all", BodyKind::soil, {0, 0, 0}, {1, 1, 0});
  scene.soils["sand"].model.law = SoilLaw::linear_elastic;
  scene.initial.stress = InitialStress::uniform;
  scene.initial.uniform_stress = {-1e4, -1e4, -1e4, 0, 0, 0};
  State<2> s = make_state<2>(scene);
  advance_times(s, 1000, 2e-4);
  for (std::size_t p = 0; p < s.soil.size(); ++p)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(s.soil.stress[p][k], -1e4, s.soil.start[p][0] < 0.2 ? 350 : 50) << s.soil.start[p][0];
}

/// The column that collapses keeps its upward momentum account and its water.
TEST(Axial, LedgerClosesWhileAHeapCollapses) {
  Scene scene = axial(1, 0.8, 0.05);
  scene.water.viscosity = 10;
  add_body(scene, "heap", BodyKind::saturated_soil, {0, 0, 0}, {0.4, 0.4, 0});
  add_body(scene, "pool", BodyKind::water, {0.4, 0, 0}, {0.7, 0.6, 0});
  add_body(scene, "dry", BodyKind::soil, {0.8, 0, 0}, {1, 0.2, 0});
  State<2> s = make_state<2>(scene);
  LedgerKeeper<2> keeper(scene, s);
  const double volume = keeper.ledger().water_volume;
  const auto last = advance_times(s, 300, 2e-4, [&](const auto& r) { keeper.add(s, r); });
  keeper.measure(s, last);
  EXPECT_LT(keeper.ledger().momentum_residual, 1e-12);
  EXPECT_GT(keeper.ledger().impulse_walls[1], 1);
  EXPECT_GT(last.max_speed, 0.1);
  EXPECT_EQ(keeper.ledger().water_mass, keeper.ledger().water_mass_initial);
  EXPECT_NEAR(keeper.ledger().water_volume / volume, 1, 0.02);
}

/// Gives every face of component d the old velocity v(radius).
template <class Velocity>
void set_velocity(State<2>& s, int d, Velocity&& v) {
  for_each_cell(s.grid, [&](int i, const Cell<2>&) {
    MassSum& water = s.sums[d].water[i];
    water.momentum = water.mass * v(s.grid.face_radius(d, i));
  });
}

/// Flow along a rough pipe dies away as J0(2.405 r/R) exp(−(2.405/R)² ν t), flow from its axis as J1.
TEST(Axial, FlowInAPipeDecaysAsBesselsFunctions) {
  Scene scene = axial(1, 0.5, 1.0 / 16);
  scene.water.viscosity = 10;
  scene.domain.sides[1].kind = SideKind::no_slip;
  add_body(scene, "water", BodyKind::water, {0, 0, 0}, {1, 0.5, 0});
  State<2> s = make_state<2>(scene);
  constexpr double kRoot = 2.404825557695773, kRate = 0.01 * kRoot * kRoot;  // 1/s
  const auto j0 = [](double r) { return std::cyl_bessel_j(0, kRoot * r); };
  const auto j1 = [](double r) { return std::cyl_bessel_j(1, kRoot * r); };
  set_velocity(s, 1, j0);
  set_velocity(s, 0, j1);
  for (int column = 0; column < 15; ++column) {
    const int i = s.grid.index({column, 4});
    EXPECT_NEAR(viscous_acceleration(s, 1, i), -kRate * j0(s.grid.face_radius(1, i)), 0.01 * kRate);
    if (column == 0) continue;  // the axis
    EXPECT_NEAR(viscous_acceleration(s, 0, i), -kRate * j1(s.grid.face_radius(0, i)), 0.01 * kRate);
  }
}

std::vector<std::string> pointers(const Scene& scene) {
  std::vector<std::string> found;
  for (const Fault& f : check(scene)) found.push_back(f.pointer);
  return found;
}

TEST(Axial, AnAxisThatIsNoneIsRefused) {
  Scene s = axial(1, 1, 0.1);
  add_body(s, "water", BodyKind::water, {0, 0, 0}, {1, 0.5, 0});
  EXPECT_TRUE(check(s).empty());
  Scene t = s;
  t.domain.min[0] = -0.1;
  EXPECT_EQ(pointers(t), std::vector<std::string>{"/domain/min"});
  t = s, t.gravity[0] = 1;
  EXPECT_EQ(pointers(t), std::vector<std::string>{"/gravity"});
  t = s, t.domain.sides[0].kind = SideKind::no_slip;
  EXPECT_EQ(pointers(t), std::vector<std::string>{"/domain/sides/left/kind"});
}

}  // namespace
}  // namespace quicksand
