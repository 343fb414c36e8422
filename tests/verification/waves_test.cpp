// Fast and slow compression waves in a saturated column against an independent solution (biot_column.hpp),
// with the pressure explicit and implicit at the same small steps.

#include <gtest/gtest.h>

#include "tests/verification/biot_column.hpp"
#include "tests/verification/oscillation.hpp"

namespace quicksand::test {
namespace {

// As in cases/waves.
constexpr BiotColumn kColumn{2, 2e9, 0.4, 2650, 1000, 2.2e9, 0.16 * 1000 * 9.81 / 0.1, 1e4, 1e-4};
constexpr double kDepth = 0.8;  // m, of the probes
/// Between the two waves, and behind the slow one before the fast one is back from the base (s).
constexpr double kBetween[2] = {6e-4, 8.5e-4}, kBehind[2] = {1.25e-3, 1.5e-3};

double mean_within(const std::vector<double>& t, const std::vector<double>& y, const double window[2]) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (t[i] >= window[0] && t[i] <= window[1]) sum += y[i], ++count;
  return sum / count;
}

/// When y first passes `level` after `from`.
double arrival(const std::vector<double>& t, const std::vector<double>& y, double level, double from) {
  for (const double at : crossings(t, y, level))
    if (at > from) return at;
  return 0;
}

void compare(Page& page, const std::string& name, const std::string& unit, double scale, const Recorded& r,
             const std::vector<double>& y, const std::vector<double>& reference_t,
             const std::vector<double>& reference) {
  const std::vector<double>& t = r.results.times;
  const double between = mean_within(reference_t, reference, kBetween),
               behind = mean_within(reference_t, reference, kBehind);
  page.near(name + " between the waves", mean_within(t, y, kBetween) / scale, between / scale, 0.02, unit);
  page.error(name + " behind both", std::abs((mean_within(t, y, kBehind) - behind) / between), 0.02,
             "of that between");  // the pressure is nearly gone there
  page.near("fast wave in " + name, arrival(t, y, between / 2, 0),
            arrival(reference_t, reference, between / 2, 0), 0.02, "s");
  const double half = (between + behind) / 2;
  page.near("slow wave in " + name, arrival(t, y, half, kBetween[0]),
            arrival(reference_t, reference, half, kBetween[0]), 0.02, "s");
  Curve curve{name + " at 0.8 m", "t (ms)", name + " (" + unit + ")", "", {}, {}};
  for (std::size_t i = 0; i < t.size(); ++i)
    curve.x.push_back(1e3 * t[i]), curve.result.push_back(y[i] / scale);
  for (std::size_t i = 0; i < reference_t.size(); i += 10)
    curve.reference_x.push_back(1e3 * reference_t[i]), curve.reference.push_back(reference[i] / scale);
  page.curve(curve);
}

void waves_page(double factor, PressureScheme scheme, const std::string& size) {
  Scene scene = load_case("waves", factor);
  scene.domain.max = {2 * scene.cell_size(), scene.domain.max[1], 0};
  scene.bodies[0].region.max[0] = scene.domain.max[0];
  for (Probe& probe : scene.output.probes) probe.at[0] = scene.cell_size();
  const double speed = wave_speeds(kColumn)[0];
  if (scheme == PressureScheme::implicit) {
    scene.numerics.pressure = scheme;
    scene.numerics.time_step = 0.4 * scene.cell_size() / speed;  // that of the explicit scheme
  }
  Page page("waves", size);
  const Recorded r = page.run(scene);
  const BiotHistory h = solve(kColumn, kDepth, scene.stages[0].duration, 2000);
  std::vector<double> grains, water;
  for (const double v : r.results.series("probe.grains", 1)) grains.push_back(-v);
  for (const double v : r.results.series("probe.water", 1)) water.push_back(-v);
  compare(page, "pore pressure", "kPa", 1e3, r, r.results.series("probe.pressure"), h.time, h.pressure);
  compare(page, "velocity of grains", "mm/s", 1e-3, r, grains, h.time, h.grains);
  compare(page, "velocity of water", "mm/s", 1e-3, r, water, h.time, h.water);
}

TEST(Waves, ExplicitPressure) { waves_page(1, PressureScheme::explicit_scheme, "explicit, 200 cells"); }
TEST(Waves, ImplicitPressureAtTheSameSteps) {
  waves_page(1, PressureScheme::implicit, "implicit, 200 cells");
}

/// The reference itself: plateaus of the two waves from their jump conditions, without drag.
TEST(Waves, ReferenceSolvesTheJumpConditions) {
  BiotColumn b = kColumn;
  b.drag = 0;
  const BiotHistory h = solve(b, kDepth, 1.5e-3, 1000);
  // Behind a wave of speed c: Ms c vs = −Δσ′ + φ Δp, Mw c vw = n Δp; σ′ = −Ec vs/c, p = Kw/n (φ vs + n vw)/c.
  // Both together carry −load in σ′ and nothing in p.
  const double n = b.porosity, f = 1 - n, q = b.bulk_modulus / n;
  const auto [fast, slow] = wave_speeds(b);
  const auto pressure_of = [&](double c) {  // per vs = 1: p = Mw c vw/n
    const double water = q * f / (b.water_density * c * c - q * n);
    return std::array<double, 2>{q * (f + n * water) / c, b.modulus / c};  // p, −σ′
  };
  const auto x = pressure_of(fast), y = pressure_of(slow);
  const double grains = b.load / (x[1] - y[1] * x[0] / y[0]);  // speed of grains in the fast wave
  EXPECT_NEAR(mean_within(h.time, h.pressure, kBetween) / (grains * x[0]), 1, 2e-3);
  EXPECT_NEAR(mean_within(h.time, h.pressure, kBehind), 0, 2e-3 * grains * x[0]);
}

}  // namespace
}  // namespace quicksand::test
