// An elastic layer whose cover is dug away: suction as large as the cover's buoyant weight first, then
// Terzaghi's series, and heave γ′ t H/Ec. See cases/unloading/README.md.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

// cases/unloading.
constexpr double kHeight = 1, kCover = 0.2, kGamma = 9810, kBuoyant = 0.6 * 1650 * 9.81;
constexpr double kModulus = 1e7 * 0.7 / (1.3 * 0.4), kDiffusion = 1e-4 * kModulus / kGamma;
constexpr double kDug = 0.2;      ///< s, end of the first stage
constexpr double kFirstT = 0.02;  ///< before, the drained front is thinner than the cells at the top

template <class Term>
double series(double t, Term&& term) {
  double sum = 0;
  for (int m = 0; m < 200; ++m) {
    const double a = (2 * m + 1) * std::numbers::pi / 2;
    sum += term(a) * std::exp(-a * a * t);
  }
  return sum;
}
/// Suction at depth z/H, of the cover's buoyant weight.
double suction(double t, double z) {
  return series(t, [z](double m) { return 2 / m * std::sin(m * z); });
}
double swelling(double t) {
  return 1 - series(t, [](double m) { return 2 / (m * m); });
}

/// Rise of the surface, continued from the two highest rows of the layer's soil points.
double heave(const Frame& frame, double spacing) {
  const auto& u = field(frame, "displacement");
  double first = 0, second = 0;
  for (std::size_t p = 0; p < frame.points(); ++p) {
    if (frame.phase[p] != 0) continue;
    const double z = kHeight - (frame.position[3 * p + 1] - u[3 * p + 1]);
    if (z > 0 && z < spacing) first = u[3 * p + 1];
    if (z > spacing && z < 2 * spacing) second = u[3 * p + 1];
  }
  return first + 0.5 * (first - second);
}

void unloading_page(int cells, double held_to) {
  Page page("unloading", std::to_string(cells) + " cells");
  Scene scene = load_case("unloading", 20.0 / cells);
  scene.domain.max[0] = 2 * scene.cell_size();
  for (Body& body : scene.bodies) body.region.max[0] = scene.domain.max[0];
  scene.output.probes[0].at[0] = scene.cell_size();
  const Recorded r = page.run(scene);
  const double cover = kBuoyant * kCover;

  Curve base{"Suction at the base", "T", "−u/γ′t", "", {}, {}}, rise{"Heave", "T", "of γ′tH/Ec", "", {}, {}};
  double base_error = 0, all_error = 0, heave_error = 0, first = -1;
  const auto p = r.results.series("probe.base");
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double t = kDiffusion * (r.results.times[i] - kDug), s = (kGamma * kHeight - p[i]) / cover;
    if (t <= 1e-9) continue;
    if (first < 0 && t > kFirstT) first = s;
    base.x.push_back(t), base.result.push_back(s), base.reference.push_back(suction(t, 1));
    if (t > kFirstT) base_error = std::max(base_error, std::abs(s - suction(t, 1)));
  }
  for (const Frame& frame : r.results.frames) {
    const double t = kDiffusion * (frame.time - kDug),
                 u = heave(frame, scene.cell_size() / 2) * kModulus / (cover * kHeight);
    if (t <= 1e-9) continue;
    rise.x.push_back(t), rise.result.push_back(u), rise.reference.push_back(swelling(t));
    if (t < kFirstT) continue;
    heave_error = std::max(heave_error, std::abs(u - swelling(t)));
    const auto& pressure = field(frame, "pore_pressure");
    for (std::size_t i = 0; i < frame.points(); ++i) {
      const double z = kHeight - frame.position[3 * i + 1];
      if (frame.phase[i] != 1) continue;
      all_error = std::max(all_error, std::abs((kGamma * z - pressure[i]) / cover - suction(t, z / kHeight)));
    }
  }
  page.near("undrained: suction at the base", first, suction(kFirstT, 1), 0.02, "of the cover's weight γ′t");
  page.error("suction at the base", base_error, held_to, "γ′t");
  page.error("suction, all points", all_error, 2 * held_to, "γ′t");
  page.error("heave of the surface", heave_error, held_to, "γ′tH/Ec");
  page.curve(base), page.curve(rise);
}

TEST(Unloading, HeavesAsTheSeriesSays) {
  unloading_page(10, 0.02);
  unloading_page(20, 0.01);
}

}  // namespace
}  // namespace quicksand::test
