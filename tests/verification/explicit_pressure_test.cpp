// The explicit scheme works on the implicit one's discrete operators: both tell one history of consolidation.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

/// cases/terzaghi in water that is soft enough for explicit steps, under a load that rises over several
/// transits of the waves: the implicit scheme damps them and the explicit one does not.
Scene softened_column() {
  Scene s = load_case("terzaghi", 2);
  const double h = s.cell_size();
  s.domain.max = {2 * h, 1 + 4 * h, 0};
  s.bodies[0].region.max[0] = 2 * h;
  s.output.probes[0].at[0] = h;
  s.soils.at("soil").permeability.value = 2e-4;
  s.water.bulk_modulus = 2e7;
  s.initial.pressure = InitialPressure::zero;
  s.initial.uniform_pressure = 0;
  s.loads[0].ramp = 1;
  s.stages[0].duration = 3.6;  // s, T = 1
  s.output.frame_interval = 3.6;
  s.output.series_interval = 0.018;
  return s;
}

TEST(ExplicitPressure, ConsolidatesAsTheImplicitSchemeDoes) {
  Scene scene = softened_column();
  const double load = -scene.loads[0].traction[1];
  scene.numerics.pressure = PressureScheme::explicit_scheme;
  const Recorded advanced = record(scene);
  scene.numerics.pressure = PressureScheme::implicit;
  scene.numerics.time_step = advanced.report.time_step_max;
  const Recorded solved = record(scene);
  ASSERT_EQ(advanced.report.status, RunStatus::succeeded) << advanced.report.failure.message;
  EXPECT_EQ(advanced.report.steps_bound_by.at(0).name, "water wave");
  EXPECT_EQ(advanced.report.pressure_iterations_mean, 0);
  EXPECT_LT(advanced.report.ledger.momentum_residual, 1e-9);
  const auto p = solved.results.series("probe.base"), q = advanced.results.series("probe.base");
  ASSERT_EQ(p.size(), q.size());
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    worst = std::max(worst, std::abs(p[i] - q[i]) / load);
    largest = std::max(largest, p[i] / load);
  }
  std::printf("explicit against implicit: largest difference %.5f of %.3f\n", worst, largest);
  EXPECT_GT(largest, 0.7);
  EXPECT_LT(worst, 0.005);  // what the ramp leaves of the undrained wave, 4H/(π c_u · ramp) of the load
}

}  // namespace
}  // namespace quicksand::test
