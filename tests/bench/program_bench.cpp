// What the general program adds to the bare steps of a scene: `run` with a sink that drops everything,
// against a loop over the same steps. Each from the same start, and each with a state to go back to when a
// step fails and with a frame at the start and at the end, which a program for one kind of scene needs as
// well.
//
//   program/<scene>/points:<n>/{steps,run}

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/run/run.hpp"
#include "tests/bench/groups.hpp"
#include "tests/bench/scenes.hpp"
#include "tests/bench/workload.hpp"

namespace quicksand::bench {
namespace {

struct Nowhere : ResultSink {
  void begin(const std::vector<SeriesInfo>&) override {}
  void frame(Frame) override {}
  void sample(double, const std::vector<double>&) override {}
};

/// Ends a run after so many steps and one more, which finds memory for the first time as the bare steps do
/// before they are timed.
struct StopAfter : RunMonitor {
  explicit StopAfter(long n) : steps(n + 1) {}
  void progress(const Progress& p) override {
    done = p.step;
    if (done == 1) begin = std::chrono::steady_clock::now();
    if (done == steps)
      seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  bool cancelled() override { return done >= steps; }
  long steps, done = 0;
  std::chrono::steady_clock::time_point begin;
  double seconds = 0;
};

void report(benchmark::State& state, double seconds, double point_steps, double points, double bytes) {
  state.SetIterationTime(seconds);
  state.counters["points"] = points;
  state.counters["ns_per_point_step"] = 1e9 * seconds / point_steps;
  state.counters["peak_bytes_per_point"] = bytes / points;
}

void bare_steps(benchmark::State& state, const Scene& scene, long steps) {
  const double before = resident_bytes();
  forget_peak();
  for (auto _ : state) {
    with_threads(1, [&] {
      const auto work = start(scene, true);
      state.counters["good_bytes_per_point"] = work->good_bytes / work->points();
      work->step();  // as far as the run, whose first step is not shorter than the others
      const auto begin = std::chrono::steady_clock::now();
      for (long i = 0; i < steps; ++i) work->step();
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
      work->last_frame();
      report(state, took.count(), work->points() * static_cast<double>(steps), work->points(),
             peak_bytes() - before);
    });
  }
}

void whole_run(benchmark::State& state, Scene scene, long steps) {
  const double before = resident_bytes();
  forget_peak();
  for (auto _ : state) {
    Nowhere sink;
    StopAfter monitor(steps);
    const RunReport done = run(scene, sink, monitor, {.threads = 1});
    const double points = done.point_steps / static_cast<double>(done.steps);
    report(state, monitor.seconds, points * static_cast<double>(steps), points, peak_bytes() - before);
  }
}

}  // namespace

void register_program(double point_steps) {
  constexpr double kPoints = 1e5, kFewestSteps = 10;
  const long steps = std::lround(std::max(kFewestSteps, point_steps / kPoints));
  for (Kind kind : {Kind::column, Kind::dam}) {
    const std::string name =
        "program/" + scene_name(kind, 2) + "/points:" + std::to_string(static_cast<long>(kPoints));
    const auto add = [&](const std::string& way, auto&& measure) {
      benchmark::RegisterBenchmark((name + way).c_str(),
                                   [=](benchmark::State& state) {
                                     measure(state, make_scene(kind, {2, kPoints, 1}), steps);
                                   })
          ->Iterations(1)
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    };
    add("/steps", bare_steps);
    add("/run", whole_run);
  }
}

}  // namespace quicksand::bench
