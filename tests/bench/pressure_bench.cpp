// The pressure solve on larger and larger grids: iterations and time per step while the scene moves.
//
//   pressure/<scene>/cells:<n>     water fills about n × n cells

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include "engine/step/step.hpp"
#include "tests/bench/scenes.hpp"
#include "tests/bench/workload.hpp"

namespace quicksand::bench {
namespace {

/// The same for every grid: the first steps after a scene is let go ask for more iterations than later ones.
constexpr int kSteps = 8;

void solve(benchmark::State& state, const Scene& scene) {
  const auto work = warm_up(scene);
  constexpr auto kPressure = static_cast<std::size_t>(Phase::pressure);
  const double before = work->phase_seconds()[kPressure];
  double iterations = 0, last = before;
  tbb::task_arena arena(1);
  arena.execute([&] {
    for (auto _ : state) {
      iterations += work->step();
      const double now = work->phase_seconds()[kPressure];
      state.SetIterationTime(now - last);
      last = now;
    }
  });
  using benchmark::Counter;
  state.counters["pressure_iterations"] = Counter(iterations, Counter::kAvgIterations);
  state.counters["s_per_iteration"] = iterations > 0 ? (last - before) / iterations : 0;
}

const bool registered = [] {
  for (Kind kind : {Kind::bed, Kind::dam})
    for (int cells : {32, 64, 128, 256, 512, 1024})
      benchmark::RegisterBenchmark(
          ("pressure/" + scene_name(kind, 2) + "/cells:" + std::to_string(cells)).c_str(),
          [=](benchmark::State& state) { solve(state, make_square(kind, cells)); })
          ->Iterations(kSteps)
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
}  // namespace quicksand::bench
