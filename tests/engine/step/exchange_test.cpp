// Momentum that goes from layer to layer by viscosity and from phase to phase by drag.

#include <gtest/gtest.h>

#include <numbers>

#include "engine/step/phases.hpp"
#include "tests/engine/step/motion.hpp"

namespace quicksand {
namespace {

using namespace test;

/// A strip of water between y = 0 and y = 1 m that shears with speed u(y) in x, its ends free, no gravity.
/// Returns the rate (1/s) at which the part of shape `shape` decays over `time` seconds.
template <class Shape>
double decay_rate(bool rough_floor, bool rough_top, double viscosity, double time, Shape&& shape) {
  Scene scene = plane(2, 1, 1.0 / 16);
  scene.gravity = {};
  scene.water.viscosity = viscosity;
  scene.numerics.pic_rate = 0;
  scene.domain.sides[2].kind = rough_floor ? SideKind::no_slip : SideKind::slip;
  scene.domain.sides[3].kind = rough_top ? SideKind::no_slip : SideKind::slip;
  add_body(scene, "strip", BodyKind::water, {0.5, 0, 0}, {1.5, 1, 0});
  State<2> s = make_state<2>(scene);
  const double start = 1e-3;  // m/s; moves the ends by less than a hundredth of a cell
  for (std::size_t p = 0; p < s.water.size(); ++p) s.water.v[p][0] = start * shape(s.water.x[p][1]);
  const int steps = 200;
  advance_times(s, steps, time / steps);
  double amount = 0, norm = 0;
  for (std::size_t p = 0; p < s.water.size(); ++p) {
    const double u = shape(s.water.x[p][1]);
    amount += s.water.v[p][0] * u;
    norm += start * u * u;
  }
  return -std::log(amount / norm) / time;
}

constexpr double kPi = std::numbers::pi;
constexpr double kViscosity = 1000;  // Pa·s, so that 1 m decays within 0.1 s at ρw = 1000 kg/m³

TEST(Viscosity, ShearBetweenRoughWalls) {
  const double rate = decay_rate(true, true, kViscosity, 0.1, [](double y) { return std::sin(kPi * y); });
  EXPECT_NEAR(rate / (kPi * kPi), 1, 0.03);
}

TEST(Viscosity, ShearBetweenARoughFloorAndASmoothTop) {
  const double rate =
      decay_rate(true, false, kViscosity, 0.1, [](double y) { return std::sin(kPi / 2 * y); });
  EXPECT_NEAR(rate / (kPi * kPi / 4), 1, 0.03);
}

TEST(Viscosity, ShearBetweenSmoothWalls) {
  const double rate = decay_rate(false, false, kViscosity, 0.1, [](double y) { return std::cos(kPi * y); });
  EXPECT_NEAR(rate / (kPi * kPi), 1, 0.03);
  const double plug = decay_rate(false, false, kViscosity, 0.1, [](double) { return 1.0; });
  EXPECT_NEAR(plug, 0, 1e-9);
}

TEST(Viscosity, WithoutItNothingDecays) {
  const double rate = decay_rate(true, true, 0, 0.1, [](double y) { return std::sin(kPi * y); });
  EXPECT_NEAR(rate, 0, 1e-6);
}

/// A saturated block in weightless air whose water moves through its grains.
State<2> passing_phases(double permeability, PermeabilityLaw law) {
  Scene scene = plane(2, 2, 0.1);
  scene.gravity = {};
  scene.initial.stress = InitialStress::zero;
  scene.initial.pressure = InitialPressure::zero;
  scene.numerics.pic_rate = 0;
  add_body(scene, "lump", BodyKind::saturated_soil, {0.2, 0.2, 0}, {1.8, 1.8, 0});
  scene.soils["sand"].permeability.value = permeability;
  scene.soils["sand"].permeability.law = law;
  State<2> s = make_state<2>(scene);
  for (auto& v : s.water.v) v = {1e-3, 0};
  return s;
}

/// Mean velocity difference of the phases in the inner half of the block.
double difference(const State<2>& s) {
  double sum = 0;
  int count = 0;
  for (std::size_t p = 0; p < s.soil.size(); ++p) {
    if (std::abs(s.soil.x[p][0] - 1) > 0.4 || std::abs(s.soil.x[p][1] - 1) > 0.4) continue;
    sum += s.water.v[p][0] - s.soil.v[p][0];
    ++count;
  }
  return sum / count;
}

TEST(DragExchange, PhasesRelaxAtTheAnalyticRate) {
  for (const double permeability : {1e-2, 1e-4}) {
    State<2> s = passing_phases(permeability, PermeabilityLaw::constant);
    const double r = 0.16 * 1000 * 9.81 / permeability, rate = r * (1 / (0.6 * 2650) + 1 / (0.4 * 1000));
    const double dt = 0.02 / rate;
    advance_times(s, 50, dt);
    // dw/dt = −rate w, implicit in each step.
    EXPECT_NEAR(difference(s) / (1e-3 * std::pow(1 + dt * rate, -50)), 1, 0.01) << permeability;
  }
}

TEST(DragExchange, FacesExchangeOneImpulse) {
  State<2> s = passing_phases(1e-3, PermeabilityLaw::constant);
  const double dt = 1e-4;
  advance(s, dt);
  double largest = 0;
  for (int d = 0; d < 2; ++d)
    for (int i = 0; i < s.grid.count(); ++i) {
      const FaceFlow& f = s.flow[d][i];
      const FaceSpeeds& v = s.speeds[d][i];
      const FaceSums& sums = s.sums[d][i];
      if (f.wet != 1 || sums.soil_mass == 0) continue;
      const double soil = sums.soil_mass * (v.soil - v.soil_old);
      const double water = sums.water_mass * (v.water - v.water_old);
      const double pressure = -dt * (sums.grains + sums.water_mass / 1000) * pressure_gradient(s, d, i);
      EXPECT_NEAR(soil + water, pressure, 1e-12 * sums.soil_mass * 1e-3);
      largest = std::max(largest, soil);
    }
  EXPECT_GT(largest, 1e-5);  // N·s; 16 kg of grains per face take up some 0.1 mm/s
}

TEST(DragExchange, StepsFarBeyondTheRelaxationAreStable) {
  State<2> s = passing_phases(1e-7, PermeabilityLaw::kozeny_carman);
  const auto report = advance_times(s, 10, 1e-4);  // 10⁶ relaxation times
  EXPECT_LT(std::abs(difference(s)), 1e-6);
  EXPECT_LT(report.max_speed, 1e-3);
  // Both go on with the speed of their common momentum, φρs·0 + nρw·v over the bulk density.
  double mean = 0;
  for (std::size_t p = 0; p < s.soil.size(); ++p) mean += s.soil.v[p][0] / static_cast<double>(s.soil.size());
  EXPECT_NEAR(mean / (1e-3 * 400 / (400 + 0.6 * 2650)), 1, 0.01);
}

/// Rate at which a filter slows a column of water down, of what Darcy's law says. Along a smooth channel
/// without gravity: 0.8 m of free water and 0.4 m of fixed sand in its middle; between the free ends
/// ρw (L1 + L2/n) dq/dt = −(ρw g/k) L2 q.
double filter_rate(double h) {
  Scene scene = plane(2, 0.2, h);
  scene.gravity = {};
  scene.water.viscosity = 0;
  scene.initial.pressure = InitialPressure::zero;
  scene.numerics.pic_rate = 0;
  add_body(scene, "before", BodyKind::water, {0.4, 0, 0}, {0.8, 0.2, 0});
  add_body(scene, "filter", BodyKind::saturated_soil, {0.8, 0, 0}, {1.2, 0.2, 0});
  scene.bodies.back().fixed = true;
  add_body(scene, "after", BodyKind::water, {1.2, 0, 0}, {1.6, 0.2, 0});
  scene.soils["sand"].permeability = {PermeabilityLaw::constant, 1e-2, 0};
  State<2> s = make_state<2>(scene);
  for (std::size_t p = 0; p < s.water.size(); ++p) s.water.v[p][0] = s.water.body[p] == 1 ? 1e-4 / 0.4 : 1e-4;
  const auto flow = [&] {  // of free water
    double sum = 0;
    int count = 0;
    for (std::size_t p = 0; p < s.water.size(); ++p)
      if (std::abs(s.water.start[p][0] - 0.55) < 0.1) sum += s.water.v[p][0], ++count;
    return sum / count;
  };
  const double rate = 9.81 / 1e-2 * 0.4 / (0.8 + 0.4 / 0.4), dt = 0.01 / rate;
  advance_times(s, 20, dt);  // edges of the filter find their profile
  const double start = flow();
  advance_times(s, 100, dt);
  return -std::log(flow() / start) / (100 * std::log(1 + dt * rate));
}

TEST(DragExchange, AFilterSlowsWaterAsDarcySays) {
  EXPECT_NEAR(filter_rate(0.05), 1, 0.02);
  EXPECT_NEAR(filter_rate(0.025), 1, 0.01);
}

}  // namespace
}  // namespace quicksand
