// Consolidation of a layer under its own buoyant weight, let go at the start: Terzaghi's series for a
// triangular excess pressure, see cases/self-weight/README.md.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

// cases/self-weight.
constexpr double kHeight = 1, kLevel = 1.2, kGamma = 9810, kBuoyant = 0.6 * 1650 * 9.81;
constexpr double kModulus = 1e7 * 0.7 / (1.3 * 0.4);
constexpr double kFirstT = 0.05;  ///< before, waves of the sudden weight cross the layer

template <class Term>
double series(double t, Term&& term) {
  double sum = 0;
  for (int m = 0; m < 200; ++m) {
    const double a = (2 * m + 1) * std::numbers::pi / 2;
    sum += term(a) * std::exp(-a * a * t);
  }
  return sum;
}
double excess(double t, double z) {
  return series(t, [z](double m) { return 2 * std::sin(m) / (m * m) * std::sin(m * z); });
}
double consolidation(double t) {
  return 1 - series(t, [](double m) { return 4 * std::sin(m) / (m * m * m); });
}

/// Settlement of the surface, continued from the two highest rows of soil points.
double settlement(const Frame& frame, double spacing) {
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

Scene layer(int cells) {
  Scene s = load_case("self-weight", 20.0 / cells);
  const double width = 2 * s.cell_size();
  s.domain.max[0] = width;
  for (Body& body : s.bodies) body.region.max[0] = width;
  s.output.probes[0].at[0] = 0.5 * width;
  return s;
}

void self_weight_page(int cells, double held_to) {
  Page page("self-weight", std::to_string(cells) + " cells");
  const Recorded r = page.run(layer(cells));
  const double end = r.results.times.back(), final = kBuoyant * kHeight * kHeight / (2 * kModulus);
  Curve base{"Excess pressure at the base", "T", "u/γ′H", "", {}, {}},
      degree{"Degree of consolidation", "T", "U", "", {}, {}};
  double pressure_error = 0, degree_error = 0;
  const auto p = r.results.series("probe.base");
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double t = r.results.times[i] / end, u = (p[i] - kGamma * kLevel) / (kBuoyant * kHeight);
    base.x.push_back(t), base.result.push_back(u), base.reference.push_back(excess(t, 1));
    if (t >= kFirstT) pressure_error = std::max(pressure_error, std::abs(u - excess(t, 1)));
  }
  for (const Frame& frame : r.results.frames) {
    const double t = frame.time / end, u = settlement(frame, kHeight / cells / 2) / final;
    degree.x.push_back(t), degree.result.push_back(u), degree.reference.push_back(consolidation(t));
    if (t < kFirstT) continue;
    degree_error = std::max(degree_error, std::abs(u - consolidation(t)));
    const auto& all = field(frame, "pore_pressure");
    for (std::size_t i = 0; i < frame.points(); ++i) {
      const double y = frame.position[3 * i + 1], u_i = all[i] - kGamma * (kLevel - y);
      if (frame.phase[i] == 1 && y < kHeight)
        pressure_error =
            std::max(pressure_error, std::abs(u_i / (kBuoyant * kHeight) - excess(t, 1 - y / kHeight)));
    }
  }
  page.error("excess pressure", pressure_error, held_to, "γ′H");
  page.error("degree of consolidation", degree_error, held_to, "–");
  page.curve(base), page.curve(degree);
}

TEST(SelfWeight, ConsolidatesAsTheSeriesSays) {
  self_weight_page(10, 0.02);
  self_weight_page(20, 0.01);
}
TEST(SlowSelfWeight, FineCells) {
  self_weight_page(40, 0.01);
  self_weight_page(80, 0.01);
}

}  // namespace
}  // namespace quicksand::test
