// Terzaghi's column over the whole range of permeability, stiffness of water and stiffness of ground, 20
// cells, quasi-static. K. Terzaghi's series with stored pore water: p/p0 = Σ 2/M sin(M z/H) exp(−M² T), c_v =
// k/γw / (1/Ec + n/Kw). p0 is what the water bears at the start; where it is much softer than the grains,
// they bear nearly all of a load at once, and what they bear adds nothing to the series: it is left out, q =
// p0.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "tests/verification/recorder.hpp"
#include "tests/verification/terzaghi_series.hpp"

namespace quicksand::test {
namespace {

constexpr double kLoad = 1, kPoisson = 0.3, kPorosity = 0.4, kGrains = 2650, kWater = 1000, kWeight = 9810;
constexpr int kCells = 20;
/// From here on errors count, as in cases/terzaghi: the series begins with a jump.
constexpr double kFirstT = 0.05;
/// Transits of the frame's wave within T = 1: fewer, and inertia shows in nature too.
constexpr double kTransits = 200;

struct Column {
  Scene scene;
  double height;  ///< m
};

/// `bulk` 0: incompressible. As high as it takes for the series, which knows no inertia, to hold: 1 m, or so
/// that a wave crosses it kTransits times.
Column column(double permeability, double bulk, double young) {
  const double modulus = young * (1 - kPoisson) / ((1 + kPoisson) * (1 - 2 * kPoisson));
  const double storage = 1 / modulus + (bulk > 0 ? kPorosity / bulk : 0);
  const double density = (1 - kPorosity) * kGrains + kPorosity * kWater;
  const double slowness =
      std::max(std::sqrt(density / modulus), bulk > 0 ? 0.1 * std::sqrt(kWater / bulk) : 0);  // s/m
  const double height = std::max(1.0, kTransits * permeability * slowness / (kWeight * storage));
  const double seconds = height * height * kWeight * storage / permeability;
  const double h = height / kCells;
  Column c{{}, height};
  Scene& s = c.scene;
  s.name = "column";
  s.domain.max = {h, height + 2 * h, 0};
  s.domain.cell_size = h;
  s.gravity = {0, 0, 0};
  Soil soil;
  soil.porosity = kPorosity, soil.grain_density = kGrains;
  soil.permeability.law = PermeabilityLaw::constant, soil.permeability.value = permeability;
  soil.model.law = SoilLaw::linear_elastic;
  soil.model.young_modulus = young, soil.model.poisson_ratio = kPoisson;
  s.soils["soil"] = soil;
  s.water.density = kWater;
  s.water.bulk_modulus = bulk > 0 ? std::optional(bulk) : std::nullopt;
  s.water.viscosity = 0;
  Body body;
  body.name = "column", body.kind = BodyKind::saturated_soil, body.soil = "soil";
  body.region = box(0, 0, h, height);
  s.bodies = {body};
  s.initial.pressure = InitialPressure::uniform, s.initial.uniform_pressure = kLoad;
  s.initial.stress = InitialStress::zero;
  Load load;
  load.name = "load", load.body = "column", load.traction = {0, -kLoad, 0};
  s.loads = {load};
  Stage stage;
  stage.name = "consolidation", stage.duration = seconds, stage.quasi_static = true;
  s.stages = {stage};
  s.output.frame_interval = seconds / 20, s.output.series_interval = seconds / 20;
  return c;
}

/// Names of what may bound a step: of the frame and of how fast things move; never drag or Kw.
const std::set<std::string> kBounds{"soil wave", "motion"};

void expect_series(double permeability, double bulk, double young) {
  SCOPED_TRACE("k = " + std::to_string(std::log10(permeability)) + ", Kw = " + std::to_string(bulk) +
               ", E = " + std::to_string(young));
  const Column c = column(permeability, bulk, young);
  const Recorded r = record(c.scene, 1);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  double worst = 0;
  const double end = c.scene.stages[0].duration;
  for (const Frame& frame : r.results.frames) {
    if (frame.time < kFirstT * end) continue;
    const auto& p = field(frame, "pore_pressure");
    for (std::size_t i = 0; i < frame.points(); ++i)
      if (frame.phase[i] == 1)
        worst = std::max(
            worst, std::abs(p[i] / kLoad -
                            terzaghi_pressure(frame.time / end, 1 - frame.position[3 * i + 1] / c.height)));
  }
  EXPECT_LE(worst, 0.02);
  for (const StepBound& bound : r.report.steps_bound_by)
    EXPECT_TRUE(kBounds.contains(bound.name)) << bound.name;
  std::printf("k %.0e Kw %.0e E %.0e: error %.4f, %ld steps, inertia %.3g\n", permeability, bulk, young,
              worst, r.report.steps, r.report.quasi_static.at(0).inertia);
}

TEST(TerzaghiRange, Corners) {
  for (const double k : {1e-12, 1e-1})
    for (const double bulk : {1e6, 0.0})
      for (const double young : {1e4, 1e10}) expect_series(k, bulk, young);
}

TEST(SlowTerzaghiRange, EverywhereWithinTwoPercent) {
  for (const double k : {1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2, 1e-1})
    for (const double bulk : {1e6, 1e8, 2.2e9, 1e11, 0.0})
      for (const double young : {1e4, 1e6, 1e8, 1e10}) expect_series(k, bulk, young);
}

}  // namespace
}  // namespace quicksand::test
