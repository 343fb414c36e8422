// A smooth strip plate on cohesive soil without weight: L. Prandtl, Nachr. Ges. Wiss. Göttingen (1920) 74–85.
// The mean pressure under it at failure is (2 + π) c.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

constexpr double kHalfWidth = 1, kCohesion = 1e4;  // cases/prandtl
constexpr double kBearing = 2 + std::numbers::pi;

void plate_page(int cells) {
  Page page("prandtl", std::to_string(cells) + " cells under half the plate");
  const Recorded r = page.run(load_case("prandtl", 16.0 / cells), {.interventions = true});
  const auto force = r.results.series("plate.plate.force"), moved = r.results.series("plate.plate.movement");
  Curve curve{"Mean pressure under the plate", "settlement / width", "q/c", "", {}, {}};
  double failure = 0;
  int count = 0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double pressure = -force[i] / (kHalfWidth * kCohesion), settlement = -moved[i] / (2 * kHalfWidth);
    curve.x.push_back(settlement), curve.result.push_back(pressure), curve.reference.push_back(kBearing);
    if (settlement > 0.02) failure += pressure, ++count;  // it yields without end
  }
  page.curve(curve);
  page.near("mean pressure at failure", failure / count, kBearing, 0.05, "c");
  EXPECT_NEAR(curve.result.back(), failure / count, 0.03 * kBearing);  // it has stopped rising
}

TEST(Prandtl, YieldsAtItsBearingCapacity) { plate_page(8); }

TEST(SlowPrandtl, FineCells) {
  plate_page(16);
  plate_page(32);
}

}  // namespace
}  // namespace quicksand::test
