// The pressure solve on larger and larger grids: iterations and time per step while the scene moves.
//
//   pressure/<scene>/cells:<n>     water fills about n × n cells

#include <benchmark/benchmark.h>

#include "engine/step/step.hpp"
#include "engine/threads/parallel.hpp"
#include "tests/bench/groups.hpp"
#include "tests/bench/scenes.hpp"
#include "tests/bench/workload.hpp"

namespace quicksand::bench {
namespace {

/// The same for every grid: the first steps after a scene is let go ask for more iterations than later ones.
constexpr int kSteps = 8, kStepsBefore = 6;
/// Least traffic of an iteration per unknown in the plane: pressure, residual and direction read and written,
/// the diagonal and two couplings read.
constexpr double kLeastBytes = (3 * 2 + 1 + 2) * sizeof(double);

void solve(benchmark::State& state, const Scene& scene) {
  const auto work = warm_up(scene, kStepsBefore);
  constexpr auto kPressure = static_cast<std::size_t>(Phase::pressure);
  const double before = work->phase_seconds()[kPressure];
  double iterations = 0, unknowns = 0, last = before;
  with_threads(1, [&] {
    for (auto _ : state) {
      const PressureReport report = work->step();
      iterations += report.iterations;
      unknowns = report.unknowns;
      const double now = work->phase_seconds()[kPressure];
      state.SetIterationTime(now - last);
      last = now;
    }
  });
  using benchmark::Counter;
  state.counters["pressure_iterations"] = Counter(iterations, Counter::kAvgIterations);
  state.counters["s_per_iteration"] = iterations > 0 ? (last - before) / iterations : 0;
  state.counters["unknowns"] = unknowns;
  state.counters["least_bytes"] = kLeastBytes * unknowns;
}

}  // namespace

void register_pressure() {
  for (Kind kind : {Kind::bed, Kind::dam})
    for (int cells : {32, 64, 128, 256, 512, 1024})
      benchmark::RegisterBenchmark(
          ("pressure/" + scene_name(kind, 2) + "/cells:" + std::to_string(cells)).c_str(),
          [=](benchmark::State& state) { solve(state, make_square(kind, cells)); })
          ->Iterations(kSteps)
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
}

}  // namespace quicksand::bench
