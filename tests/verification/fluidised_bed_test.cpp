// Water that rises through sand until it carries it, and beyond: minimum fluidisation and the height of the
// bed by S. Ergun's law (1952). See cases/fluidised-bed/README.md.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

// cases/fluidised-bed.
constexpr double kHeight = 0.1, kPorosity = 0.4, kGrain = 5e-4, kRise = 20, kHold = 10;
constexpr double kWeight = (1 - kPorosity) * 1.65 * kHeight;  ///< m of water, buoyant, of the bed
constexpr double kMinimum = 2.801e-3;                         ///< m/s, q_mf by Ergun's law
constexpr double kTwice = 1.164, kFourTimes = 1.444;          ///< H/H0 at 2 and 4 q_mf
/// A part of the buoyant weight: over these pressure drops the fixed bed's line is fitted.
constexpr double kFitFrom = 0.2, kFitTo = 0.8;
/// Means are taken over these last seconds of a stage.
constexpr double kWindow = 3;

/// Ergun's pressure drop through the bed at rest, m of water.
double resting_drop(double q) {
  const double n3 = kPorosity * kPorosity * kPorosity, solid = 1 - kPorosity;
  const double viscous = 150 * 1e-3 * solid * solid / (n3 * kGrain * kGrain),
               inertial = 1.75 * 1e3 * solid / (n3 * kGrain);
  return (viscous * q + inertial * q * q) * kHeight / 9810;
}

/// Histories of a run, per area of the column.
struct Bed {
  std::vector<double> time, flow, drop, height;  ///< s, m/s, parts of the weight, H/H0
  double mean(const std::vector<double>& of, double until) const {
    double sum = 0;
    long count = 0;
    for (std::size_t i = 0; i < time.size(); ++i)
      if (time[i] > until - kWindow && time[i] <= until) sum += of[i], ++count;
    return sum / static_cast<double>(count);
  }
};

Bed histories(const Recorder& r, double width) {
  Bed bed;
  bed.time = r.times;
  const auto level = r.series("reservoir.below.level"), head = r.series("probe.above the bed"),
             rise = r.series("body.bed.rise"), flow = r.series("section.into the bed");
  for (std::size_t i = 0; i < r.times.size(); ++i) {
    bed.flow.push_back(flow[i] / width);
    bed.drop.push_back((level[i] - head[i]) / kWeight);
    bed.height.push_back(1 + 2 * rise[i] / kHeight);  // a uniform bed's middle rises half as much as its top
  }
  return bed;
}

/// Flow at which the resting bed's line, a q + b q² fitted to what was measured, meets `plateau`.
double meets(const Bed& bed, double plateau) {
  double qq = 0, qqq = 0, qqqq = 0, dq = 0, dqq = 0;
  for (std::size_t i = 0; i < bed.time.size() && bed.time[i] <= kRise; ++i) {
    const double d = bed.drop[i], q = bed.flow[i] / kMinimum;
    if (d < kFitFrom || d > kFitTo) continue;
    qq += q * q, qqq += q * q * q, qqqq += q * q * q * q, dq += d * q, dqq += d * q * q;
  }
  const double determinant = qq * qqqq - qqq * qqq;
  const double a = (dq * qqqq - dqq * qqq) / determinant, b = (dqq * qq - dq * qqq) / determinant;
  return kMinimum * 2 * plateau / (a + std::sqrt(a * a + 4 * b * plateau));
}

void fluidised_bed_page(double factor, const std::string& size) {
  Page page("fluidised-bed", size);
  Scene scene = load_case("fluidised-bed", factor);
  const double width = scene.cell_size();  // one column of cells
  const auto narrow = [&](double& right) { right = width; };
  narrow(scene.domain.max[0]);
  for (Body& body : scene.bodies) narrow(body.region.max[0]);
  for (Reservoir& reservoir : scene.reservoirs) narrow(reservoir.line.to[0]);
  narrow(scene.output.sections[0].line.to[0]);
  scene.output.probes[0].at[0] = 0.5 * width;
  const Recorded r = page.run(scene, {.water_volume_drift = 0.02});
  const Bed bed = histories(r.results, width);
  EXPECT_NEAR(resting_drop(kMinimum), kWeight, 1e-3 * kWeight);  // the constants are Ergun's
  const double carried = bed.mean(bed.drop, kRise);
  page.near("pressure drop of the bed just carried", carried, 1, 0.01, "of its buoyant weight");
  page.near("flow that just carries the bed, q_mf", meets(bed, carried), kMinimum, 0.02, "m/s");
  const double two = kRise + kHold, four = two + kHold;
  page.near("height at 2 q_mf", bed.mean(bed.height, two), kTwice, 0.05, "H0");
  page.near("height at 4 q_mf", bed.mean(bed.height, four), kFourTimes, 0.05, "H0");
  page.value("flow then, meant to be 2", bed.mean(bed.flow, two) / kMinimum, "q_mf");
  page.value("flow then, meant to be 4", bed.mean(bed.flow, four) / kMinimum, "q_mf");

  Curve drop{"Pressure drop of the bed, flow rising", "q/q_mf", "Δp/weight", size, {}, {}};
  for (std::size_t i = 0; i < bed.time.size() && bed.time[i] <= kRise; ++i)
    drop.x.push_back(bed.flow[i] / kMinimum), drop.result.push_back(bed.drop[i]);
  for (int i = 0; i <= 25; ++i) {
    drop.reference_x.push_back(0.05 * i);
    drop.reference.push_back(std::min(1.0, resting_drop(0.05 * i * kMinimum) / kWeight));
  }
  page.curve(drop);
  page.curve({"Height of the bed",
              "t, s",
              "H/H0",
              size,
              bed.time,
              bed.height,
              {1, 1, kTwice, kTwice, kFourTimes, kFourTimes},
              {0, kRise, kRise, two, two, four}});
}

TEST(FluidisedBed, IsCarriedAndExpandsByErgunsLaw) { fluidised_bed_page(1, "cells of 10 mm"); }
TEST(SlowFluidisedBed, IsCarriedAndExpandsByErgunsLaw) { fluidised_bed_page(0.5, "cells of 5 mm"); }

}  // namespace
}  // namespace quicksand::test
