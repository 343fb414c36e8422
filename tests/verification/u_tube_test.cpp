// Water in a U-tube. L dv/dt = −2 g η with the length L of a straight tube of equal inertia, so that
// T = 2π √(L/2g). A square bend of the tube has, in potential flow, the inertia of 0.5587 widths of straight
// tube (the same number that counts a corner square of a sheet resistor, by conformal mapping).

#include <gtest/gtest.h>

#include <numbers>

#include "tests/verification/oscillation.hpp"

namespace quicksand::test {
namespace {

// cases/u-tube, m.
constexpr double kWidth = 0.2, kLeg = 0.2, kBottom = 2, kRise = 0.01, kGravity = 9.81;
constexpr double kBend = 0.5587;
constexpr double kLength = 2 * kLeg + kBottom + 2 * kBend * kWidth;

/// Squares of the largest amplitudes of each half period, the first 1.
std::vector<double> swing_energies(const std::vector<double>& t, const std::vector<double>& x, double middle,
                                   double period) {
  std::vector<double> peak{0};
  std::size_t half = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const auto now = static_cast<std::size_t>(2 * t[i] / period + 0.5);
    if (now != half) peak.push_back(0), half = now;
    peak.back() = std::max(peak.back(), std::pow((x[i] - middle) / (x.front() - middle), 2));
  }
  peak.pop_back();  // begun only
  return peak;
}

double loss_per_period(const std::vector<double>& swings) {
  return 1 - std::pow(swings.back(), 2.0 / static_cast<double>(swings.size() - 1));
}

/// Pa; of the swing it is 2.1, of the order of ρ g a · 2π/T · 0.01 s; water that strikes makes it a thousand.
constexpr double kJump = 4;
/// Pa, of the pressure in a leg between two samples once the release is over.
double largest_jump(const Recorded& r) {
  double jump = 0;
  for (const char* leg : {"probe.left shaft", "probe.right shaft"}) {
    const std::vector<double> p = r.results.series(leg);
    for (std::size_t i = 10; i < p.size(); ++i) jump = std::max(jump, std::abs(p[i] - p[i - 1]));
  }
  return jump;
}

/// `loss` and `rise` hold the loss per period and the rise of the sum of all energies, which contains what
/// the water gains when its points pack a little more loosely.
void u_tube_page(double factor, const std::string& size, double loss, double rise) {
  Scene scene = load_case("u-tube", factor);
  Page page("u-tube", size);
  const Recorded r = page.run(scene, {.interventions = true});
  const double expected = 2 * std::numbers::pi * std::sqrt(kLength / (2 * kGravity));
  const std::vector<double> t = frame_times(r), x = centers(r), energy = r.results.series("ledger.energy");
  const double middle = 1.2, amplitude = middle - x.front();
  page.near("period", period(crossings(t, x, middle)), expected, 0.01, "s");
  // Of the energy that swings: ρ g b a².
  const double swinging = 1000 * kGravity * kWidth * kRise * kRise;
  const std::vector<double> swings = swing_energies(t, x, middle, expected);
  page.error("energy of the swing, loss per period", loss_per_period(swings), loss, "–");
  page.error("energy of the swing, largest growth", largest_rise(swings), 0, "–");
  page.error("all energy, largest rise", largest_rise(energy) / swinging, rise, "of the swing's");
  page.error("water volume, largest drift", r.report.ledger.water_volume_drift_max, 0.001, "–");
  page.error("pressure in a leg, largest change between samples", largest_jump(r), kJump, "Pa");
  Curve swing{"Centre of mass", "t (s)", "(x − x of rest) / amplitude", size, t, {}};
  for (std::size_t i = 0; i < t.size(); ++i) {
    swing.result.push_back((x[i] - middle) / amplitude);
    swing.reference.push_back(-std::cos(2 * std::numbers::pi * t[i] / expected));
  }
  page.curve(swing);
  Curve lost{"All energy", "t (s)", "(E − E at the start) / energy of the swing", size, r.results.times, {}};
  for (const double e : energy) lost.result.push_back((e - energy.front()) / swinging);
  page.curve(lost);
}

TEST(UTube, SwingsInItsPeriod) { u_tube_page(2, "cells of 20 mm", 0.07, 0.05); }
TEST(SlowUTube, SwingsInItsPeriod) { u_tube_page(1, "cells of 10 mm", 0.05, 0.02); }

/// Where points part at the bends, no water strikes into what looks like air (engine/step/gaps.cpp).
TEST(SlowUTube, HasNoBlowsOnFineCells) {
  const Recorded r = record(load_case("u-tube", 0.5));
  EXPECT_LT(largest_jump(r), kJump);
  EXPECT_EQ(r.report.ledger.cut_steps, 0);
  EXPECT_LT(r.report.ledger.water_volume_drift_max, 1e-5);
}

}  // namespace
}  // namespace quicksand::test
