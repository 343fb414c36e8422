// Upward flow through a uniform layer between smooth walls: at rest below i_c = (1−n)(Gs−1), heave above
// (K. Terzaghi).

#include <gtest/gtest.h>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

// cases/critical-gradient.
constexpr double kThickness = 0.12, kPool = 0.16, kCritical = 0.6 * 1.65;
constexpr double kModulus = 1e7 * 0.7 / (1.3 * 0.4), kBuoyant = kCritical * 9810;

/// Water volume in the heaving run: the gap opens on the reservoir's own cells, where a cell is as high as
/// it.
constexpr double kDriftInHeave = 0.05;
/// The pool stands on its overflow, whose water comes and goes point by point.
constexpr double kDriftAtRest = 2e-3;

Recorded run_at(Page& page, double factor, const std::string& size, double part, double drift, Curve& rise) {
  Scene scene = load_case("critical-gradient", factor);
  scene.stages[1].heads["below"] = kPool + part * kCritical * kThickness;
  char label[32];
  std::snprintf(label, sizeof label, "%g i_c", part);
  Recorded r = page.run(scene, {.water_volume_drift = drift, .interventions = true}, label);
  rise = {"Rise of the layer", "t (s)", "mean rise (mm)", label + std::string(", ") + size,
          r.results.times,     {}};
  for (const double u : r.results.series("body.sand.rise")) rise.result.push_back(1e3 * u);
  return r;
}

void critical_gradient_page(double factor, const std::string& size) {
  Page page("critical-gradient", size);
  Curve below, above;
  const Recorded rest = run_at(page, factor, size, 0.98, kDriftAtRest, below);
  // What an elastic layer swells when its weight is taken off: mean of γ′ i/i_c (H z − z²/2)/Ec.
  const double swelling = 0.98 * kBuoyant * kThickness * kThickness / (3 * kModulus);
  page.near("mean rise at 0.98 i_c, elastic", rest.results.last("body.sand.rise"), swelling, 0.1, "m");
  page.error("speed of grains at 0.98 i_c", rest.results.last("max_soil_speed"), 1e-6, "m/s");
  const double gradient =
      (rest.results.last("probe.below sand") - rest.results.last("probe.above sand")) / kThickness;
  page.near("gradient at 0.98 i_c", gradient, 0.98 * kCritical, 0.02, "–");
  const Recorded heave = run_at(page, factor, size, 1.02, kDriftInHeave, above);
  const double risen = heave.results.last("body.sand.rise");
  page.value("mean rise at 1.02 i_c", risen, "m");
  EXPECT_GT(risen, 100 * swelling);
  page.curve(below), page.curve(above);
}

TEST(CriticalGradient, IsBracketedWithinTwoPerCent) { critical_gradient_page(2, "cells of 20 mm"); }
TEST(SlowCriticalGradient, IsBracketedWithinTwoPerCent) { critical_gradient_page(1, "cells of 10 mm"); }

}  // namespace
}  // namespace quicksand::test
