// Collapse of dry columns of aspect ratio a = H0/L0 on a rough floor. Runout (L∞−L0)/L0 = 1.2 a for a < 2.3
// in channels: G. Lube et al., Phys. Rev. E 72 (2005) 041301; E. Lajeunesse et al., Phys. Fluids 17 (2005)
// 103302.

#include <gtest/gtest.h>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

constexpr double kWidth = 0.1;  // cases/column-collapse, m
/// Part of the grains within the deposit's front: a few that roll ahead do not count.
constexpr double kDeposit = 0.995;

/// Front of the deposit, m.
double front_of(const Frame& frame, double half_spacing) {
  std::vector<double> x;
  for (std::size_t p = 0; p < frame.points(); ++p) x.push_back(frame.position[3 * p]);
  std::sort(x.begin(), x.end());
  return x[static_cast<std::size_t>(kDeposit * static_cast<double>(x.size()))] + half_spacing;
}

/// `measured` holds the relative error of the runout, larger than the case's 10 % where that is not met.
void collapse_page(double factor, double aspect, double measured) {
  char size[64];
  std::snprintf(size, sizeof size, "a = %g, cells of %g mm", aspect, 5 * factor);
  Scene scene = load_case("column-collapse", factor);
  scene.bodies[0].region.max[1] = aspect * kWidth;
  Page page("column-collapse", size);
  const Recorded r = page.run(scene, {.interventions = true});
  const double half_spacing = 0.5 * scene.cell_size() / scene.numerics.points_per_cell;
  Curve front{"Front", "t √(g/H0)", "(L − L0)/(a L0)", size, {}, {}};
  for (const Frame& frame : r.results.frames) {
    front.x.push_back(frame.time * std::sqrt(9.81 / (aspect * kWidth)));
    front.result.push_back((front_of(frame, half_spacing) / kWidth - 1) / aspect);
  }
  front.reference = {1.2, 1.2};
  front.reference_x = {0, front.x.back()};
  page.missed_near("runout", front.result.back() * aspect, 1.2 * aspect, 0.1, measured, "L0");
  page.value("fastest grain at the end", r.results.last("max_speed"), "m/s");
  page.curve(front);
}

TEST(ColumnCollapse, RunsOutAsMeasured) {
  for (const double aspect : {0.5, 1.0, 2.0}) collapse_page(2, aspect, 0.1);
}
TEST(SlowColumnCollapse, RunsOutAsMeasured) {
  for (const double aspect : {0.5, 1.0}) collapse_page(1, aspect, 0.1);
  collapse_page(1, 2, 0.16);
}

}  // namespace
}  // namespace quicksand::test
