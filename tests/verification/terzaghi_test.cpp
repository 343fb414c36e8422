// One-dimensional consolidation of an elastic column under a load on its drained top, no gravity:
// K. Terzaghi's series for the excess pressure at the base, p/q = Σ 2/M sin M exp(−M² T), M = (2m+1)π/2.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/verification/recorder.hpp"

namespace quicksand::test {
namespace {

constexpr double kLoad = 1e4, kHeight = 1, kYoung = 1e7, kPoisson = 0.3;

double base_pressure(double t) {
  double sum = 0;
  for (int m = 0; m < 200; ++m) {
    const double a = (2 * m + 1) * std::numbers::pi / 2;
    sum += 2 / a * std::sin(a) * std::exp(-a * a * t);
  }
  return sum;
}

double constrained_modulus() { return kYoung * (1 - kPoisson) / ((1 + kPoisson) * (1 - 2 * kPoisson)); }

Scene column(double permeability, int cells) {
  Scene s;
  s.name = "Terzaghi";
  const double h = kHeight / cells;
  s.domain.max = {2 * h, kHeight + 4 * h, 0};
  s.domain.cell_size = h;
  s.gravity = {0, 0, 0};
  Soil soil;
  soil.permeability = {PermeabilityLaw::constant, permeability, 0};
  soil.model.young_modulus = kYoung;
  soil.model.poisson_ratio = kPoisson;
  s.soils["soil"] = soil;
  Body body;
  body.name = "column";
  body.kind = BodyKind::saturated_soil;
  body.soil = "soil";
  body.region = box(0, 0, 2 * h, kHeight);
  s.bodies = {body};
  Load load;
  load.name = "load";
  load.body = "column";
  load.traction = {0, -kLoad, 0};
  s.loads = {load};
  s.initial.pressure = InitialPressure::uniform;
  s.initial.uniform_pressure = kLoad;
  s.initial.stress = InitialStress::zero;
  Stage stage;
  stage.name = "consolidation";
  stage.duration = kHeight * kHeight * 9810 / (permeability * constrained_modulus());  // T = 1
  s.stages = {stage};
  s.output.frame_interval = stage.duration;
  s.output.series_interval = stage.duration / 200;
  Probe probe;
  probe.name = "base";
  probe.at = {h, 1e-6, 0};
  probe.quantity = "pore_pressure";
  s.output.probes = {probe};
  return s;
}

/// Largest |p/q − series| for T ≥ 0.05.
double largest_error(double permeability, int cells) {
  const Recorded r = record(column(permeability, cells));
  EXPECT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  EXPECT_EQ(r.report.ledger.clipped_points + r.report.ledger.clamped_values + r.report.ledger.cut_steps, 0);
  const auto p = r.results.series("probe.base");
  double worst = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double t = r.results.times[i] / r.results.times.back();
    if (t >= 0.05) worst = std::max(worst, std::abs(p[i] / kLoad - base_pressure(t)));
  }
  ::testing::Test::RecordProperty("largest_error", std::to_string(worst));
  std::printf("k = %g m/s, %d cells: largest error %.5f\n", permeability, cells, worst);
  return worst;
}

/// Required is 0.015; measured is 0.0035. A figure half as large again would be a change to look at.
constexpr double kTolerance = 0.005;

TEST(Terzaghi, BasePressureFollowsTheSeries) {
  EXPECT_LT(largest_error(1e-4, 20), kTolerance);
  EXPECT_LT(largest_error(1e-5, 20), kTolerance);
}

TEST(Terzaghi, FinerCellsAreCloser) { EXPECT_LT(largest_error(1e-4, 20), 0.6 * largest_error(1e-4, 5)); }

/// Settlement at the end: U(1) q H / Ec, on the surface.
TEST(Terzaghi, SettlesAsMuchAsTheSeriesSays) {
  const Recorded r = record(column(1e-4, 20));
  double consolidation = 1;
  for (int m = 0; m < 200; ++m) {
    const double a = (2 * m + 1) * std::numbers::pi / 2;
    consolidation -= 2 / (a * a) * std::exp(-a * a);
  }
  const Frame& last = r.results.frames.back();
  const auto& u = field(last, "displacement");
  double top = 0, height = 0;
  for (std::size_t p = 0; p < last.points(); ++p)
    if (last.phase[p] == 0 && last.position[3 * p + 1] > height) {
      height = last.position[3 * p + 1];
      top = -u[3 * p + 1];
    }
  const double expected = consolidation * kLoad * kHeight / constrained_modulus();
  EXPECT_NEAR(top / (height / kHeight), expected, 0.01 * expected);
}

}  // namespace
}  // namespace quicksand::test
