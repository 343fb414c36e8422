// Suspended grains settle: velocity against Richardson and Zaki, see cases/settling/README.md.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

// cases/settling.
constexpr double kHeight = 0.2, kPorosity = 0.84, kTouching = 0.45;
constexpr double kStokes = 1e-4 * 1e-4 * 9.81 * 1.65 / (18 * 1e-6);  // m/s, v_t
/// While the upper edge falls freely, before the bed comes near it, s.
constexpr double kFirst = 2, kLast = 20;

struct Height {
  double top = 0, mean = 0;  ///< m
};
Height height_of(const Frame& frame) {
  Height h;
  std::size_t grains = 0;
  for (std::size_t p = 0; p < frame.points(); ++p) {
    if (frame.phase[p] != 0) continue;
    h.top = std::max<double>(h.top, frame.position[3 * p + 1]);
    h.mean += frame.position[3 * p + 1];
    ++grains;
  }
  h.mean /= static_cast<double>(grains);
  return h;
}

void settling_page(double factor, const std::string& size) {
  Page page("settling", size);
  Scene scene = load_case("settling", factor);
  scene.domain.max[0] = scene.bodies[0].region.max[0] = 2 * scene.cell_size();
  const Recorded r = page.run(scene, {.water_volume_drift = 0.005, .interventions = true});
  const double expected = kStokes * std::pow(kPorosity, 4.65);
  Curve edge{"Upper edge of the grains",         "t (s)", "height (m)", size, {}, {},
             {kHeight, kHeight - expected * 35}, {0, 35}};
  double first = 0, last = 0;
  for (const Frame& frame : r.results.frames) {
    const double top = height_of(frame).top;
    edge.x.push_back(frame.time), edge.result.push_back(top);
    if (frame.time < kFirst + 1e-6) first = top;
    if (frame.time < kLast + 1e-6) last = top;
  }
  page.near("settling velocity", (first - last) / (kLast - kFirst), expected, 0.1, "m/s");
  const double bed = 2 * height_of(r.results.frames.back()).mean;
  page.near("settled porosity", 1 - (1 - kPorosity) * kHeight / bed, kTouching, 0.1, "–");
  page.error("water volume, largest drift", r.report.ledger.water_volume_drift_max, 0.005, "–");
  page.value("fastest point at the end", r.results.last("max_speed"), "m/s");
  page.curve(edge);
}

TEST(Settling, FollowsRichardsonAndZaki) { settling_page(2, "cells of 10 mm"); }
TEST(SlowSettling, FollowsRichardsonAndZaki) { settling_page(1, "cells of 5 mm"); }

}  // namespace
}  // namespace quicksand::test
