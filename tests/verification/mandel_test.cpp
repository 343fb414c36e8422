// J. Mandel's problem: a saturated elastic block of half width a between rigid, smooth plates that press with
// F per half and metre; water leaves through the sides. A. Cheng and E. Detournay, "A direct boundary element
// method for plane strain poroelasticity", Int. J. Numer. Anal. Meth. Geomech. 12 (1988), with incompressible
// grains; T = c t/a²:
//   p = p0 Σ A (cos αx/a − cos α) exp(−α² T), A = 2 sin α/(α − sin α cos α), tan α = (1−ν)/(νu−ν) α
//   p0 = B (1+νu)/3 F/a
//   settlement = F H/(2 G a) [(1−ν) − 2 (1−νu) Σ sin α cos α/(α − sin α cos α) exp(−α² T)]

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

// Of cases/mandel; the data of [FMS19].
constexpr double kHalfWidth = 100, kHeight = 20, kForce = 1e7, kPorosity = 0.4, kWater = 2e9;
constexpr double kPermeability = 1e-5, kWaterWeight = 9810, kConstrained = 5e9, kQ = kWater / kPorosity;
constexpr double kConsolidation = kPermeability / kWaterWeight / (1 / kConstrained + 1 / kQ);  // m²/s
constexpr double kUnitTime = kHalfWidth * kHalfWidth / kConsolidation;                         // s, T = 1
/// From here on errors count: before, the wave of the sides that drain at once crosses the block.
constexpr double kFirstT = 0.02;

struct Mandel {
  double nu, shear, undrained_nu, p0;
  std::vector<double> roots;

  explicit Mandel(double poisson) : nu(poisson) {
    const double bulk = kConstrained * (1 + nu) / (3 * (1 - nu)), undrained_bulk = bulk + kQ;
    shear = 0.5 * kConstrained * (1 - 2 * nu) / (1 - nu);
    undrained_nu = (3 * undrained_bulk - 2 * shear) / (2 * (3 * undrained_bulk + shear));
    p0 = kQ / undrained_bulk * (1 + undrained_nu) / 3 * kForce / kHalfWidth;
    for (int m = 0; m < 300; ++m) roots.push_back(root(m));
  }
  double young() const { return 2 * shear * (1 + nu); }

  /// p/p0 at x/a.
  double pressure(double x, double t) const {
    return sum(t, [&](double a) { return a > 0 ? 2 * std::sin(a) * (std::cos(a * x) - std::cos(a)) : 0; });
  }
  /// Settlement over F H/(2 G a).
  double settlement(double t) const {
    const double part = sum(t, [](double a) { return std::sin(a) * std::cos(a); });
    return (1 - nu) - 2 * (1 - undrained_nu) * part;
  }
  /// p/p0 under a load that rises linearly over 0…rise.
  double pressure_after_rise(double x, double t, double rise) const {
    double p = 0;
    for (const double a : roots) {
      const double factor = 2 * std::sin(a) * (std::cos(a * x) - std::cos(a)) / weight(a);
      p += factor * (std::exp(-a * a * std::max(t - rise, 0.0)) - std::exp(-a * a * t)) / (a * a * rise);
    }
    return p;
  }
  double peak() const {
    double most = 0;
    for (double t = 0.01; t < 0.2; t += 1e-4) most = std::max(most, pressure(0, t));
    return most;
  }

 private:
  static double weight(double a) { return a - std::sin(a) * std::cos(a); }
  template <class F>
  double sum(double t, F&& f) const {
    double s = 0;
    for (const double a : roots) s += f(a) / weight(a) * std::exp(-a * a * t);
    return s;
  }
  /// The root of tan α = r α in (mπ, mπ + π/2), by bisection.
  double root(int m) const {
    const double r = (1 - nu) / (undrained_nu - nu), begin = m * std::numbers::pi;
    const auto f = [&](double a) { return std::sin(a) - r * a * std::cos(a); };
    double low = begin + (m ? 1e-9 : 1e-3), high = begin + std::numbers::pi / 2;
    const bool sign = f(low) > 0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      ((f(middle) > 0) == sign ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
};

/// The case with another ν at the same constrained modulus, beginning with that one's undrained answer.
Scene block(const Mandel& m, int cells) {
  Scene s = load_case("mandel", 40.0 / cells);
  auto& model = s.soils.at("soil").model;
  model.young_modulus = m.young(), model.poisson_ratio = m.nu;
  const double load = kForce / kHalfWidth;
  s.initial.uniform_pressure = m.p0;
  s.initial.uniform_stress = {m.p0, m.p0 - load, m.nu * (2 * m.p0 - load), 0, 0, 0};
  return s;
}

struct Place {
  const char* probe;
  double x;  ///< –, x/a
};
constexpr Place kProfile[] = {{"quarter", 0.25}, {"half", 0.5}, {"three_quarters", 0.75}};

struct Errors {
  double centre = 0, profile = 0, everywhere = 0, settlement = 0, peak = 0;
};

/// Largest difference of a probe from `reference`(T), of p0, from `kFirstT` on.
template <class F>
double largest_error(const Recorded& r, const Mandel& m, const std::string& probe, F&& reference) {
  const auto p = r.results.series("probe." + probe);
  double error = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double t = r.results.times[i] / kUnitTime;
    if (t >= kFirstT) error = std::max(error, std::abs(p[i] / m.p0 - reference(t)));
  }
  return error;
}

/// The profiles at three times, and the largest error at any water point of any frame.
double frames(Page& page, const Recorded& r, const Mandel& m) {
  double error = 0;
  for (const Frame& frame : r.results.frames) {
    const double t = frame.time / kUnitTime;
    if (t < kFirstT - 1e-9) continue;
    Curve profile{"Pressure over the width, T = 0.02, 0.1, 0.5", "x/a", "p/p0", "", {}, {}};
    const auto& p = field(frame, "pore_pressure");
    for (std::size_t i = 0; i < frame.points(); ++i) {
      if (frame.phase[i] != 1) continue;
      const double x = std::min(frame.position[3 * i] / kHalfWidth, 1.0), expected = m.pressure(x, t);
      error = std::max(error, std::abs(p[i] / m.p0 - expected));
      if (frame.position[3 * i + 1] > 0.5 * (frame.position[1] + kHeight / 8)) continue;
      profile.x.push_back(x), profile.result.push_back(p[i] / m.p0), profile.reference.push_back(expected);
    }
    for (const double shown : {0.02, 0.1, 0.5})
      if (std::abs(t - shown) < 1e-3) page.curve(profile);
  }
  return error;
}

Errors mandel_page(double nu, int cells, double held_to) {
  const Mandel m(nu);
  char size[64];
  std::snprintf(size, sizeof size, "ν = %g, %d cells", nu, cells);
  Page page("mandel", size);
  const Recorded r = page.run(block(m, cells));
  EXPECT_TRUE(r.report.quasi_static.at(0).negligible);
  Errors e;
  Curve centre{"Pressure at the centre", "T", "p/p0", "", {}, {}},
      sunk{"Settlement of the plate", "T", "of its last", "", {}, {}};
  const auto p = r.results.series("probe.centre"), moved = r.results.series("plate.plate.movement");
  const double unit = kForce * kHeight / (2 * m.shear * kHalfWidth), last = 1 - nu, first = m.settlement(0);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double t = r.results.times[i] / kUnitTime, u = first - moved[i] / unit, expected = m.settlement(t);
    if (t >= kFirstT) {
      e.peak = std::max(e.peak, p[i] / m.p0);
      e.settlement = std::max(e.settlement, std::abs(u - expected) / last);
    }
    centre.x.push_back(t), centre.result.push_back(p[i] / m.p0), centre.reference.push_back(m.pressure(0, t));
    sunk.x.push_back(t), sunk.result.push_back(u / last), sunk.reference.push_back(expected / last);
  }
  page.curve(centre), page.curve(sunk);
  e.centre = largest_error(r, m, "centre", [&](double t) { return m.pressure(0, t); });
  for (const Place& at : kProfile)
    e.profile =
        std::max(e.profile, largest_error(r, m, at.probe, [&](double t) { return m.pressure(at.x, t); }));
  e.everywhere = frames(page, r, m);
  page.error("pressure at the centre", e.centre, held_to, "of p0");
  page.error("pressure at x/a = 0.25, 0.5, 0.75", e.profile, held_to, "of p0");
  page.near("largest pressure at the centre", e.peak, m.peak(), 0.005, "p0");
  page.error("settlement of the plate", e.settlement, held_to, "of its last");
  page.error("pressure at all points", e.everywhere, held_to, "of p0");
  return e;
}

/// From an independent inversion of the Laplace transform, ν = 0.3: rows of T = 0.02, 0.05, 0.1, 0.5, columns
/// of x/a = 0, 0.25, 0.5, 0.75.
TEST(Mandel, TheSeriesIsThePublishedOne) {
  const Mandel m(0.3);
  EXPECT_NEAR(m.p0, 0.2916666666666667 * kForce / kHalfWidth, 1e-3);
  EXPECT_NEAR(kConsolidation, 2.5484199796126403, 1e-9);
  constexpr double kTimes[] = {0.02, 0.05, 0.1, 0.5}, kPlaces[] = {0, 0.25, 0.5, 0.75};
  constexpr double kPressure[][4] = {
      {1.0271605607701482, 1.0269834668169615, 1.0146074295905037, 0.812441978767169},
      {1.0403047111479469, 1.0253794581088593, 0.9270192598065856, 0.6010675325588407},
      {1.0103215896369628, 0.9605594308167547, 0.7877978582038385, 0.4581811285216889},
      {0.45342711659452406, 0.4198725336952646, 0.32360601865723204, 0.17724854647029653}};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(m.pressure(kPlaces[j], kTimes[i]), kPressure[i][j], 1e-9);
  const Scene shipped = load_case("mandel"), made = block(m, 40);
  EXPECT_NEAR(shipped.initial.uniform_pressure, made.initial.uniform_pressure, 1e-6);
  for (int k = 0; k < 4; ++k)
    EXPECT_NEAR(shipped.initial.uniform_stress[k], made.initial.uniform_stress[k], 1e-6);
  EXPECT_NEAR(shipped.soils.at("soil").model.young_modulus, m.young(), 1);
  EXPECT_NEAR(shipped.stages[0].duration, kUnitTime, 1e-3);
}

TEST(Mandel, RisesAndFallsAsTheSeries) {
  const Errors coarse = mandel_page(0.3, 10, 0.03), fine = mandel_page(0.3, 20, 0.01);
  EXPECT_GE(std::log2(coarse.centre / fine.centre), 1);
  EXPECT_GE(std::log2(coarse.everywhere / fine.everywhere), 1.5);
}

/// From nothing: the plate makes the undrained answer itself, under a load that rises over T = 0…0.02.
/// Inertia is scaled less, as what the load excites is not damped.
TEST(Mandel, ThePlateMakesTheUndrainedAnswer) {
  constexpr double kRise = 0.02, kEnd = 0.12;
  const Mandel m(0.3);
  Page page("mandel", "ν = 0.3, 20 cells, load rising over T = 0.02");
  Scene s = block(m, 20);
  s.initial.pressure = InitialPressure::zero, s.initial.stress = InitialStress::zero;
  s.initial.uniform_pressure = 0, s.initial.uniform_stress = {};
  s.loads[0].ramp = kRise * kUnitTime;
  s.stages[0].duration = kEnd * kUnitTime;
  s.numerics.quasi_static_transits = 100;
  const Recorded r = page.run(s);
  Curve centre{"Pressure at the centre, rising load", "T", "p/p0", "", {}, {}};
  const auto p = r.results.series("probe.centre");
  double peak = 0, expected_peak = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double t = r.results.times[i] / kUnitTime;
    centre.x.push_back(t), centre.result.push_back(p[i] / m.p0);
    centre.reference.push_back(m.pressure_after_rise(0, t, kRise));
    peak = std::max(peak, centre.result.back());
    expected_peak = std::max(expected_peak, centre.reference.back());
  }
  page.curve(centre);
  double error = largest_error(r, m, "centre", [&](double t) { return m.pressure_after_rise(0, t, kRise); });
  for (const Place& at : kProfile)
    error = std::max(error, largest_error(r, m, at.probe,
                                          [&](double t) { return m.pressure_after_rise(at.x, t, kRise); }));
  page.error("pressure at x/a = 0, 0.25, 0.5, 0.75", error, 0.01, "of p0");
  page.near("largest pressure at the centre", peak, expected_peak, 0.005, "p0");
}

TEST(SlowMandel, FineCells) { mandel_page(0.3, 40, 0.01); }

TEST(SlowMandel, OtherPoissonRatios) {
  for (const double nu : {0.0, 0.45}) mandel_page(nu, 40, 0.01);
}

}  // namespace
}  // namespace quicksand::test
