// Elastic bodies that move: a bar's vibration, a throw, a turn.

#include <gtest/gtest.h>

#include <numbers>

#include "tests/verification/oscillation.hpp"

namespace quicksand::test {
namespace {

constexpr double kPi = std::numbers::pi;

/// Amplitude of the lowest mode of cases/elastic-bar in each frame, mm: displacement against cos(π s/L), s
/// from the left end.
std::vector<double> lowest_mode(const Recorded& r) {
  constexpr double kLeft = 0.2;  // m; the bar is 1 m long
  std::vector<double> amplitude;
  for (const Frame& frame : r.results.frames) {
    const auto& u = field(frame, "displacement");
    double sum = 0;
    for (std::size_t p = 0; p < frame.points(); ++p) {
      const double start = frame.position[3 * p] - u[3 * p];
      sum -= 2e3 * u[3 * p] * std::cos(kPi * (start - kLeft));
    }
    amplitude.push_back(sum / static_cast<double>(frame.points()));
  }
  return amplitude;
}

void bar_page(double factor, const std::string& size) {
  Page page("elastic-bar", size);
  const Recorded r = page.run(load_case("elastic-bar", factor));
  const double speed = std::sqrt(1e7 / (0.6 * 2650)), expected = 2 / speed;  // s
  const std::vector<double> t = frame_times(r), mode = lowest_mode(r);
  page.near("frequency of the lowest mode", 1 / period(crossings(t, mode, 0)), 1 / expected, 0.01, "Hz");
  // u = Σ (4 v0/(π (2k+1) ω)) sin ωt …: of the lowest mode 4 v0/(π ω).
  const double amplitude = 1e3 * 0.05 * 4 / kPi * expected / (2 * kPi);
  page.near("its amplitude", *std::max_element(mode.begin(), mode.end()), amplitude, 0.03, "mm");
  Curve curve{"Lowest mode", "t (s)", "amplitude (mm)", size, t, mode};
  for (const double at : t) curve.reference.push_back(amplitude * std::sin(2 * kPi * at / expected));
  page.curve(curve);
}

TEST(ElasticBar, SwingsAtItsFrequency) {
  bar_page(2, "20 cells");
  bar_page(1, "40 cells");
}

TEST(FreeFall, ParabolaWithoutStress) {
  Page page("free-fall", "draft");
  const Scene scene = load_case("free-fall");
  const Recorded r = page.run(scene);
  double away = 0, stress = 0;
  const Frame& last = r.results.frames.back();
  const double dt = r.report.time_step_max;
  for (const Frame& frame : r.results.frames) {
    const auto &u = field(frame, "displacement"), &sigma = field(frame, "effective_stress");
    for (std::size_t p = 0; p < frame.points(); ++p) {
      const double t = frame.time;
      away = std::max<double>(away, std::abs(u[3 * p] - 0.1 * t));
      away = std::max<double>(away, std::abs(u[3 * p + 1] - (2.943 * t - 0.5 * 9.81 * t * t)));
      for (int i = 0; i < 4; ++i) stress = std::max<double>(stress, std::abs(sigma[4 * p + i]));
    }
  }
  EXPECT_NEAR(last.time, 0.6, 1e-12);
  // Positions follow the new velocity of each step: ½ g t Δt below the parabola.
  page.error("way from the parabola", away, 0.5 * 9.81 * 0.6 * dt + 1e-6, "m");
  // What faces below the mass cut-off leave as the block comes into new cells.
  const double weight = 0.6 * 2650 * 9.81 * 0.3;  // Pa, of the block on its base
  page.error("effective stress", stress / weight, 1e-6, "of its own weight");
}

/// Stress invariants of every point, averaged over frames: trace and the deviator's norm, Pa.
struct Invariants {
  std::vector<double> trace, deviator;
};
Invariants mean_invariants(const std::vector<Frame>& frames, std::size_t from, std::size_t to) {
  const std::size_t points = frames[from].points();
  Invariants sum{std::vector<double>(points, 0), std::vector<double>(points, 0)};
  for (std::size_t k = from; k < to; ++k) {
    const auto& s = field(frames[k], "effective_stress");
    for (std::size_t p = 0; p < points; ++p) {
      const double xx = s[4 * p], yy = s[4 * p + 1], zz = s[4 * p + 2], xy = s[4 * p + 3];
      const double m = (xx + yy + zz) / 3, part = 1 / static_cast<double>(to - from);
      sum.trace[p] += part * 3 * m;
      sum.deviator[p] +=
          part * std::sqrt((xx - m) * (xx - m) + (yy - m) * (yy - m) + (zz - m) * (zz - m) + 2 * xy * xy);
    }
  }
  return sum;
}

double mean(const std::vector<double>& y) {
  double sum = 0;
  for (const double v : y) sum += v;
  return sum / static_cast<double>(y.size());
}

/// Largest change between two turns over all points, of the largest value.
double change(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::abs(a[i] - b[i]));
    largest = std::max(largest, std::abs(a[i]));
  }
  return worst / largest;
}

/// Mean of Σ x × v over the points about their middle, m²/s.
double spin_of(const Frame& frame) {
  const auto& v = field(frame, "velocity");
  double x = 0, y = 0, spin = 0;
  const auto n = static_cast<double>(frame.points());
  for (std::size_t p = 0; p < frame.points(); ++p)
    x += frame.position[3 * p] / n, y += frame.position[3 * p + 1] / n;
  for (std::size_t p = 0; p < frame.points(); ++p)
    spin += ((frame.position[3 * p] - x) * v[3 * p + 1] - (frame.position[3 * p + 1] - y) * v[3 * p]) / n;
  return spin;
}

/// Three turns; the stress swings some forty times in each.
void spin_page(double factor, const std::string& size) {
  Page page("spinning-block", size);
  const Recorded r = page.run(load_case("spinning-block", factor));
  const auto& frames = r.results.frames;
  const std::size_t turn = (frames.size() - 1) / 3;
  const Invariants before = mean_invariants(frames, turn, 2 * turn),
                   after = mean_invariants(frames, 2 * turn, 3 * turn);
  page.near("trace, mean over the block, against the turn before", mean(after.trace) / mean(before.trace), 1,
            0.01, "–");
  page.near("deviator, mean over the block, against the turn before",
            mean(after.deviator) / mean(before.deviator), 1, 0.01, "–");
  // Points swing about their stress, and not in step from turn to turn.
  page.missed_error("change of the trace over a turn, all points", change(before.trace, after.trace), 0.01,
                    0.12, "of the largest");
  page.missed_error("change of the deviator over a turn, all points", change(before.deviator, after.deviator),
                    0.01, 0.17, "of the largest");
  const double rate = 10, density = 0.6 * 2650, square = (0.2 * 0.2 + 0.1 * 0.1) / 12;  // m², mean of r²
  const double expected = 1.3 * density * rate * rate * square;  // xx + yy, and ν of them across
  page.near("mean of the trace", mean(after.trace), expected, 0.01, "Pa");
  page.near("angular momentum of the points after three turns",
            spin_of(frames.back()) / spin_of(frames.front()), 1, 0.01, "–");
  const std::vector<double> energy = r.results.series("ledger.energy");
  page.value("energy lost in three turns", 1 - energy.back() / energy.front(), "–");
  Curve curve{"Trace of the effective stress, mean over the block", "turns", "Pa", size, {}, {}};
  for (std::size_t k = 0; k < frames.size(); k += 3) {
    curve.x.push_back(frames[k].time * rate / (2 * kPi));
    curve.result.push_back(mean(mean_invariants(frames, k, k + 1).trace));
    curve.reference.push_back(expected);
  }
  page.curve(curve);
}

TEST(SpinningBlock, StressTurnsWithIt) { spin_page(1, "20 × 10 cells"); }

}  // namespace
}  // namespace quicksand::test
