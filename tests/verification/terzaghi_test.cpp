// One-dimensional consolidation of an elastic column under a load on its drained top, no gravity:
// K. Terzaghi's series for the excess pressure, p/q = Σ 2/M sin(M z/H) exp(−M² T), M = (2m+1)π/2, and the
// degree of consolidation U = 1 − Σ 2/M² exp(−M² T); z from the drained top.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "tests/verification/book.hpp"
#include "tests/verification/terzaghi_series.hpp"

namespace quicksand::test {
namespace {

constexpr double kLoad = 1e3, kHeight = 1, kYoung = 1e7, kPoisson = 0.3;  // of cases/terzaghi
constexpr double kModulus = kYoung * (1 - kPoisson) / ((1 + kPoisson) * (1 - 2 * kPoisson));
/// Pore water stores some of what drains: c_v = k/γw / (1/Ec + n/Kw), 0.24 % less than with rigid water.
constexpr double kStorage = 1 / kModulus + 0.4 / 2.2e9;  // 1/Pa
/// From here on errors count: before, the load's wave crosses the column (T = 0.017 at k = 1e-3 m/s).
constexpr double kFirstT = 0.05;

double consolidation(double t) {
  double sum = 0;
  for (int m = 0; m < 200; ++m) {
    const double a = (2 * m + 1) * std::numbers::pi / 2;
    sum += 2 / (a * a) * std::exp(-a * a * t);
  }
  return 1 - sum;
}

/// The case with another permeability, over T = 0…1, on a column two cells wide.
Scene column(double permeability, int cells, bool quasi_static) {
  Scene s = load_case("terzaghi", 20.0 / cells);
  const double h = s.cell_size(), seconds = kHeight * kHeight * 9810 * kStorage / permeability;
  s.domain.max = {2 * h, kHeight + 4 * h, 0};
  s.bodies[0].region.max[0] = 2 * h;
  s.output.probes[0].at[0] = h;
  s.soils.at("soil").permeability.value = permeability;
  s.stages[0].duration = seconds;
  s.stages[0].quasi_static = quasi_static;
  s.output.frame_interval = seconds / 100;
  s.output.series_interval = seconds / 200;
  return s;
}

/// Settlement of the surface, continued from the displacements of the two highest rows of points.
double settlement(const Frame& frame, double spacing) {
  const auto& u = field(frame, "displacement");
  double first = 0, second = 0;
  for (std::size_t p = 0; p < frame.points(); ++p) {
    if (frame.phase[p] != 0) continue;
    const double z = kHeight - (frame.position[3 * p + 1] - u[3 * p + 1]);  // at the start
    if (z < spacing)
      first = -u[3 * p + 1];
    else if (z < 2 * spacing)
      second = -u[3 * p + 1];
  }
  return first + 0.5 * (first - second);
}

struct Errors {
  double pressure = 0, consolidation = 0;
  long steps = 0;
  bool negligible = true;  ///< inertia, as the run says
};

Errors run_column(Page& page, const Scene& scene) {
  const Recorded r = page.run(scene);
  Errors e;
  const double spacing = 0.5 * scene.cell_size();
  const double end = r.results.times.back();
  Curve base{"Excess pressure at the base", "T", "p/q", "", {}, {}},
      degree{"Degree of consolidation", "T", "U", "", {}, {}};
  const auto p = r.results.series("probe.base");
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double t = r.results.times[i] / end;
    if (t >= kFirstT) e.pressure = std::max(e.pressure, std::abs(p[i] / kLoad - terzaghi_pressure(t, 1)));
    base.x.push_back(t), base.result.push_back(p[i] / kLoad),
        base.reference.push_back(terzaghi_pressure(t, 1));
  }
  for (const Frame& frame : r.results.frames) {
    const double t = frame.time / end, u = settlement(frame, spacing) * kModulus / (kLoad * kHeight);
    degree.x.push_back(t), degree.result.push_back(u), degree.reference.push_back(consolidation(t));
    if (t < kFirstT) continue;
    e.consolidation = std::max(e.consolidation, std::abs(u - consolidation(t)));
    const auto& all = field(frame, "pore_pressure");
    for (std::size_t i = 0; i < frame.points(); ++i) {
      const double z = 1 - frame.position[3 * i + 1] / kHeight;
      if (frame.phase[i] == 1)
        e.pressure = std::max(e.pressure, std::abs(all[i] / kLoad - terzaghi_pressure(t, std::max(z, 0.0))));
    }
  }
  page.curve(base), page.curve(degree);
  e.steps = r.report.steps;
  if (!r.report.quasi_static.empty()) {
    e.negligible = r.report.quasi_static.at(0).negligible;
    page.value("largest kinetic over strain energy", r.report.quasi_static.at(0).inertia_ratio, "–");
    page.value("inertia multiplied by", r.report.quasi_static.at(0).inertia, "–");
  }
  return e;
}

Errors terzaghi_page(double permeability, int cells, double held_to, bool quasi_static = false) {
  char size[64];
  std::snprintf(size, sizeof size, "k = %g m/s, %d cells%s", permeability, cells,
                quasi_static ? ", quasi-static" : "");
  Page page("terzaghi", size);
  const Errors e = run_column(page, column(permeability, cells, quasi_static));
  EXPECT_TRUE(e.negligible);
  page.error("pressure at all points", e.pressure, held_to, "of the load");
  page.error("degree of consolidation", e.consolidation, held_to, "–");
  return e;
}

/// Orders of convergence over three sizes, from the ends; measured are 2.3 and 2.0.
constexpr double kOrder = 1.5;
TEST(Terzaghi, ConvergesWithTheCells) {
  const Errors coarse = terzaghi_page(1e-4, 10, 0.02), middle = terzaghi_page(1e-4, 20, 0.01),
               fine = terzaghi_page(1e-4, 40, 0.005);
  std::printf("orders: pressure %.2f %.2f, U %.2f %.2f\n", std::log2(coarse.pressure / middle.pressure),
              std::log2(middle.pressure / fine.pressure),
              std::log2(coarse.consolidation / middle.consolidation),
              std::log2(middle.consolidation / fine.consolidation));
  EXPECT_GE(0.5 * std::log2(coarse.pressure / fine.pressure), kOrder);
  EXPECT_GE(0.5 * std::log2(coarse.consolidation / fine.consolidation), kOrder);
}

/// Days to years in the same number of steps.
TEST(Terzaghi, QuasiStaticCostsTheSameAtAnyPermeability) {
  long least = std::numeric_limits<long>::max(), most = 0;
  for (const double k : {1e-6, 1e-9, 1e-11}) {
    const Errors e = terzaghi_page(k, 20, 0.01, true);
    least = std::min(least, e.steps), most = std::max(most, e.steps);
  }
  EXPECT_LE(most, 20000);
  EXPECT_LE(static_cast<double>(most), 1.02 * static_cast<double>(least));
}

/// Fewer transits of a wave within the process's time: fewer steps, and more of the wave in the answer. From
/// 200 on, the default, what is left is the error of the cells.
TEST(SlowTerzaghi, WhatScaledInertiaCosts) {
  std::map<int, Errors> measured;
  for (const int transits : {12, 25, 50, 100, 200, 400, 800}) {
    Scene scene = column(1e-9, 20, true);
    scene.numerics.quasi_static_transits = transits;
    char size[64];
    std::snprintf(size, sizeof size, "k = 1e-09 m/s, 20 cells, %d transits", transits);
    Page page("terzaghi", size);
    const Errors e = measured[transits] = run_column(page, scene);
    page.value("steps per T", static_cast<double>(e.steps), "–");
    page.value("pressure at all points, error", e.pressure, "of the load");
    page.value("degree of consolidation, error", e.consolidation, "–");
    std::printf("%d transits: %ld steps, %.4f of the load, %.4f of U, negligible: %d\n", transits, e.steps,
                e.pressure, e.consolidation, e.negligible);
  }
  EXPECT_FALSE(measured.at(12).negligible);  // and the run says so
  EXPECT_TRUE(measured.at(200).negligible);
  EXPECT_GT(measured.at(12).pressure, 3 * measured.at(200).pressure);
  EXPECT_LT(measured.at(200).pressure, 1.2 * measured.at(800).pressure);
  EXPECT_NEAR(static_cast<double>(measured.at(400).steps) / static_cast<double>(measured.at(200).steps), 2,
              0.1);
}

TEST(SlowTerzaghi, QuasiStaticFineCells) {
  for (const double k : {1e-6, 1e-11}) terzaghi_page(k, 80, 0.003, true);
}

/// The load's wave needs T = 0.017 to cross the column: what is left of it bounds the error here.
TEST(Terzaghi, FollowsTheSeriesWhereInertiaMatters) { terzaghi_page(1e-3, 20, 0.01); }

TEST(SlowTerzaghi, FollowsTheSeriesAtLowPermeability) {
  for (const double k : {1e-5, 1e-6}) terzaghi_page(k, 20, 0.01);
}

TEST(SlowTerzaghi, FineCells) {
  for (const double k : {1e-3, 1e-4, 1e-5}) terzaghi_page(k, 80, 0.003);
}

}  // namespace
}  // namespace quicksand::test
