// One-dimensional consolidation at large strain, without weight: K. H. Xie and C. J. Leo, Computers and
// Geotechnics 31 (2004) 301–314. With k/k0 = ((1+e)/(1+e0))² and constant compressibility m the equation in
// the coordinate of the start is linear in exp(m u), so that with S = Σ 2/M sin(M z/H) exp(−M² Tv)
//   u = ln(1 + (exp(m q) − 1) S)/m,   settlement = H (1 − exp(−m q)) (1 − Σ 2/M² exp(−M² Tv)),
// M = (2i+1)π/2, Tv = k0 t/(γw m H²), z from the drained top at the start.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/verification/book.hpp"
#include "tests/verification/terzaghi_series.hpp"

namespace quicksand::test {
namespace {

// Of cases/large-strain-consolidation: the law of linear elasticity in rates has σ′ = ln(stretch)/m.
constexpr double kLoad = 1e5, kHeight = 1, kCompressibility = 1e-5, kDuration = 9.81e6;
constexpr double kFirstT = 0.05;

double pressure(double t, double z) {
  return std::log1p(std::expm1(kCompressibility * kLoad) * terzaghi_pressure(t, z)) / kCompressibility;
}
double settlement(double t) {
  double rest = 0;
  for (int i = 0; i < 200; ++i) {
    const double m = (2 * i + 1) * std::numbers::pi / 2;
    rest += 2 / (m * m) * std::exp(-m * m * t);
  }
  return -kHeight * std::expm1(-kCompressibility * kLoad) * (1 - rest);
}

/// Settlement of the surface, continued from the two highest rows of points.
double measured_settlement(const Frame& frame, double spacing) {
  const auto& u = field(frame, "displacement");
  double first = 0, second = 0;
  for (std::size_t p = 0; p < frame.points(); ++p) {
    if (frame.phase[p] != 0) continue;
    const double z = kHeight - (frame.position[3 * p + 1] - u[3 * p + 1]);
    if (z < spacing)
      first = -u[3 * p + 1];
    else if (z < 2 * spacing)
      second = -u[3 * p + 1];
  }
  return first + 0.5 * (first - second);
}

void column_page(int cells, double base_held_to) {
  Page page("large-strain-consolidation", std::to_string(cells) + " cells");
  Scene scene = load_case("large-strain-consolidation", 40.0 / cells);
  const double h = scene.cell_size();
  scene.domain.max[0] = scene.bodies[0].region.max[0] = h;
  scene.output.probes[0].at[0] = 0.5 * h;
  const Recorded r = page.run(scene, {.water_volume_drift = 0.01});
  double base = 0, settled = 0;
  Curve pressures{"Excess pressure at the base", "Tv", "u/q", "", {}, {}},
      settlements{"Settlement of the surface", "Tv", "m", "", {}, {}};
  const auto p = r.results.series("probe.base");
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double t = r.results.times[i] / kDuration, expected = pressure(t, kHeight);
    if (t >= kFirstT) base = std::max(base, std::abs(p[i] - expected) / kLoad);
    pressures.x.push_back(t), pressures.result.push_back(p[i] / kLoad);
    pressures.reference.push_back(expected / kLoad);
  }
  for (const Frame& frame : r.results.frames) {
    const double t = frame.time / kDuration, expected = settlement(t);
    const double u = measured_settlement(frame, h / scene.numerics.points_per_cell);
    if (t >= kFirstT) settled = std::max(settled, std::abs(u - expected) / settlement(1e3));
    settlements.x.push_back(t), settlements.result.push_back(u), settlements.reference.push_back(expected);
  }
  page.curve(pressures), page.curve(settlements);
  page.error("settlement", settled, 0.01, "of the final one");
  page.error("pressure at the base", base, base_held_to, "of the load");
  EXPECT_TRUE(r.report.quasi_static.at(0).negligible);
}

TEST(LargeStrain, FollowsXieAndLeo) {
  column_page(20, 0.02);
  column_page(40, 0.01);
}

TEST(SlowLargeStrain, FineCells) { column_page(80, 0.01); }

}  // namespace
}  // namespace quicksand::test
