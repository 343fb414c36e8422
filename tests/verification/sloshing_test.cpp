// Standing wave in a tank, lowest mode: ω² = g κ tanh(κ d), κ = π/L.

#include <gtest/gtest.h>

#include <numbers>

#include "tests/verification/oscillation.hpp"

namespace quicksand::test {
namespace {

constexpr double kLength = 1, kDepth = 0.5, kGravity = 9.81;  // cases/sloshing, m, m/s²

void sloshing_page(double factor, double seconds, const std::string& size) {
  Scene scene = load_case("sloshing", factor);
  scene.stages[0].duration = seconds;
  Page page("sloshing", size);
  const Recorded r = page.run(scene);
  const double wave = std::numbers::pi / kLength;
  const double expected =
      2 * std::numbers::pi / std::sqrt(kGravity * wave * std::tanh(wave * kDepth));  // 1.181816 s
  const std::vector<double> t = frame_times(r), x = centers(r);
  const double middle = 0.5 * kLength;
  std::vector<double> moved;
  for (const double c : x) moved.push_back(1e3 * (c - middle));
  std::vector<double> zero = crossings(t, moved, 0);
  page.near("period", period(zero), expected, 0.01, "s");
  page.error("water volume, largest drift", r.report.ledger.water_volume_drift_max, 0.001, "–");
  const std::vector<double> energy = r.results.series("ledger.energy");
  const double amplitude = *std::max_element(moved.begin(), moved.end());
  Curve swing{"Centre of mass", "t (s)", "x − x of rest (mm)", size, t, moved};
  for (const double at : t)
    swing.reference.push_back(amplitude * std::sin(2 * std::numbers::pi * at / expected));
  page.curve(swing);
}

TEST(Sloshing, SwingsInItsPeriod) { sloshing_page(2, 6, "cells of 25 mm"); }
TEST(SlowSloshing, SwingsInItsPeriod) { sloshing_page(1, 6, "cells of 12.5 mm"); }

}  // namespace
}  // namespace quicksand::test
