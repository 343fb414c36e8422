// Reservoirs, seepage faces and open sides: what flows, what is booked.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/engine/small_scene.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand::test {
namespace {

Segment along(double x0, double y0, double x1, double y1) { return {{x0, y0, 0}, {x1, y1, 0}}; }

/// Fixed sand of k = 1 cm/s under and over reservoirs of the given heads.
Scene pressed_column(double below, double above, double duration) {
  Scene s = plane(0.04, 0.2, 0.01, duration);
  add_body(s, "sand", BodyKind::saturated_soil, {0, 0, 0}, {0.04, 0.2, 0});
  s.bodies[0].fixed = true;
  s.soils["sand"].permeability = {.law = PermeabilityLaw::constant, .value = 1e-2};
  s.reservoirs = {{"below", along(0, 0, 0.04, 0), below}, {"above", along(0, 0.2, 0.04, 0.2), above}};
  s.output.sections = {{"middle", along(0, 0.1, 0.04, 0.1), "flow"}};
  s.output.frame_interval = duration;
  s.output.series_interval = duration / 20;
  return s;
}

void expect_balanced(const Ledger& l) {
  EXPECT_NEAR(l.water_mass, l.water_mass_initial + l.water_in - l.water_out, 1e-12 * l.water_mass_initial);
  EXPECT_LT(l.momentum_residual, 1e-10);
  EXPECT_EQ(l.clamped_values, 0);
}

TEST(Ports, FlowBetweenTwoReservoirsIsDarcys) {
  const double expected = 1e-2 * 0.1 / 0.2 * 0.04;  // k i A
  for (const double sign : {1.0, -1.0}) {
    const Recorded r = record(pressed_column(0.3, 0.3 - sign * 0.1, 4));
    EXPECT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
    for (const char* name : {"section.middle", "reservoir.below.inflow"})
      EXPECT_NEAR(r.results.last(name), sign * expected, 0.01 * expected) << name;
    expect_balanced(r.report.ledger);
    EXPECT_GT(r.report.ledger.water_in, 0.9 * 4 * 1000 * expected);
    EXPECT_LT(r.report.ledger.water_volume_drift_max, 1e-3);
  }
}

/// Points of free water carry more than the pores' share: they pass a filter, and the port behind it, in
/// lumps.
TEST(Ports, AFilterBehindFreeWaterResistsByItsThickness) {
  Scene s = plane(0.01, 0.1, 0.01, 10);
  add_body(s, "sand", BodyKind::saturated_soil, {0, 0.06, 0}, {0.01, 0.1, 0});
  add_body(s, "water", BodyKind::water, {0, 0, 0}, {0.01, 0.06, 0});
  s.bodies[0].fixed = true;
  s.soils["sand"].permeability = {.law = PermeabilityLaw::constant, .value = 2e-4};
  s.water.bulk_modulus.reset();
  s.numerics.drift_time = 0;
  const double discharge = 5.6e-3;
  s.reservoirs = {{"below", along(0, 0, 0.01, 0), 0.2 + discharge / 2e-4 * 0.04},
                  {"above", along(0, 0.1, 0.01, 0.1), 0.2}};
  s.output.sections = {{"free", along(0, 0.03, 0.01, 0.03), "flow"}};
  s.output.frame_interval = 10;
  s.output.series_interval = 0.02;
  const auto flow = record(s).results.series("section.free");
  const auto half = flow.begin() + static_cast<std::ptrdiff_t>(flow.size() / 2);
  const double mean = std::accumulate(half, flow.end(), 0.0) / static_cast<double>(flow.end() - half);
  EXPECT_NEAR(mean, discharge * 0.01, 0.003 * discharge * 0.01);
}

/// The mean rise after 2 s of sand on a filter ten times as tight, under water that rises through both with
/// `part` of the flow that just carries the sand.
double rise_over_tight_filter(double part) {
  constexpr double kSand = 1e-3, kFilter = 1e-4;
  Scene s = plane(0.01, 0.1, 0.01, 2);
  add_body(s, "filter", BodyKind::saturated_soil, {0, 0, 0}, {0.01, 0.02, 0});
  add_body(s, "sand", BodyKind::saturated_soil, {0, 0.02, 0}, {0.01, 0.06, 0});
  add_body(s, "water", BodyKind::water, {0, 0.06, 0}, {0.01, 0.1, 0});
  s.bodies[0].fixed = true;
  s.bodies[0].soil = "filter";
  s.soils["filter"] = sand();
  s.soils["filter"].permeability = {.law = PermeabilityLaw::constant, .value = kFilter};
  s.soils["sand"].permeability = {.law = PermeabilityLaw::constant, .value = kSand};
  const double discharge = part * 0.99 * kSand;
  s.reservoirs = {{"below", along(0, 0, 0.01, 0), 0.12}, {"above", along(0, 0.1, 0.01, 0.1), 0.12}};
  s.stages[0].heads = {{"below", 0.12 + discharge * (0.02 / kFilter + 0.04 / kSand)}};
  s.stages[0].heads_ramp = 0.5;
  s.output.frame_interval = 2;
  s.output.series_interval = 0.1;
  const Recorded r = record(s);
  expect_balanced(r.report.ledger);
  return r.results.last("body.sand.rise");
}

/// The face between them holds grains of both, but the filter's head is lost on the filter.
TEST(Ports, ATightFilterDoesNotLiftTheSandOnIt) {
  EXPECT_LT(rise_over_tight_filter(0.95), 1e-5);
  EXPECT_GT(rise_over_tight_filter(1.2), 1e-4);
}

TEST(Ports, EqualHeadsDoNothing) {
  const Recorded r = record(pressed_column(0.25, 0.25, 1));
  EXPECT_LT(r.report.ledger.water_in + r.report.ledger.water_out, 1e-12);
  EXPECT_LT(r.results.last("max_speed"), 1e-9);
}

TEST(Ports, HeadsGoLinearlyToTheirNewValues) {
  Scene s = pressed_column(0.3, 0.3, 1);
  s.stages[0].heads = {{"above", 0.2}};
  s.stages[0].heads_ramp = 0.5;
  const Recorded r = record(s);
  const auto level = r.results.series("reservoir.above.level");
  EXPECT_NEAR(level[5], 0.25, 1e-3);  // at 0.25 s
  EXPECT_NEAR(level.back(), 0.2, 1e-12);
}

/// Water of 0.2 m beside sand whose other side is open: Charny's theorem, q = k H²/(2 L), holds whatever the
/// height of the seepage face.
TEST(Ports, SeepageFaceOfADamGivesCharnysFlow) {
  Scene s = plane(0.4, 0.24, 0.02, 60);
  s.domain.sides[1].kind = SideKind::open;
  add_body(s, "sand", BodyKind::saturated_soil, {0, 0, 0}, {0.4, 0.2, 0});
  s.bodies[0].fixed = true;
  s.soils["sand"].permeability = {.law = PermeabilityLaw::constant, .value = 1e-2};
  s.reservoirs = {{"lake", along(0, 0, 0, 0.24), 0.2}};
  s.output.sections = {{"middle", along(0.2, 0, 0.2, 0.24), "flow"}};
  s.output.frame_interval = 60;
  s.output.series_interval = 0.1;
  const Recorded r = record(s);
  const auto flow = r.results.series("section.middle");
  const double mean = std::accumulate(flow.end() - 20, flow.end(), 0.0) / 20;
  const double expected = 1e-2 * 0.04 / 0.8;
  EXPECT_NEAR(mean, expected, 0.03 * expected);
  expect_balanced(r.report.ledger);
}

TEST(Ports, BlocksAndPoolsLeaveThroughOpenSides) {
  Scene s = plane(0.5, 0.4, 0.02, 1.5);
  s.domain.sides[2].kind = SideKind::open;
  add_body(s, "lump", BodyKind::soil, {0.1, 0.1, 0}, {0.2, 0.2, 0});
  add_body(s, "drop", BodyKind::water, {0.3, 0.1, 0}, {0.4, 0.2, 0});
  s.output.frame_interval = 1.5;
  const Recorded r = record(s);
  EXPECT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const Ledger& l = r.report.ledger;
  EXPECT_NEAR(l.soil_out, l.solid_mass_initial, 1e-12 * l.solid_mass_initial);
  EXPECT_NEAR(l.water_out, l.water_mass_initial, 1e-12 * l.water_mass_initial);
  EXPECT_EQ(r.results.frames.back().points(), 0u);
  EXPECT_LT(l.momentum_residual, 1e-10);
}

/// A pool filled from an empty box by a reservoir stands at its level in the end.
TEST(Ports, AReservoirFillsAnEmptyBoxToItsLevel) {
  Scene s = plane(0.2, 0.3, 0.02, 6);
  add_body(s, "puddle", BodyKind::water, {0, 0, 0}, {0.2, 0.04, 0});
  s.water.viscosity = 0.5;
  s.reservoirs = {{"lake", along(0, 0, 0, 0.3), 0.2}};
  s.output.frame_interval = 6;
  const Recorded r = record(s);
  EXPECT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  EXPECT_NEAR(r.report.ledger.water_volume, 0.2 * 0.2, 0.03 * 0.04);
  expect_balanced(r.report.ledger);
}

}  // namespace
}  // namespace quicksand::test
