// The time step: point-steps per second, where its time goes, and what it holds in memory.
//
//   step/<scene>/points:<n>/threads:<t>
//   room/<scene>/points:<n>/room:<1|10>     the same scene in a domain of 1 or 100 times the area

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>

#include "tests/bench/groups.hpp"
#include "tests/bench/limit.hpp"
#include "tests/bench/scenes.hpp"
#include "tests/bench/workload.hpp"

namespace quicksand::bench {
namespace {

/// Steps of one measurement at least, so that no single one decides, and at most: few points take long steps,
/// and a step's cost follows the scene's course (tests/bench/README.md).
constexpr double kFewestSteps = 3, kMostSteps = 40;
/// Steps of a pair in domains of two sizes, of which the larger may be a hundred times slower.
constexpr long kRoomSteps = 5;
constexpr double kRoomPoints = 1e4;

/// s, of all threads of the process.
double cpu_seconds() {
  rusage used;
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

void report(benchmark::State& state, const Workload& work, const PhaseSeconds& before, double point_steps,
            double iterations, double cpu) {
  using benchmark::Counter;
  state.counters["point_steps_per_s"] = Counter(point_steps, Counter::kIsRate);
  state.counters["ns_per_point_step"] = Counter(1e-9 * point_steps, Counter::kIsRate | Counter::kInvert);
  state.counters["cpu_ns_per_point_step"] = 1e9 * cpu / point_steps;
  state.counters["points"] = work.points();
  state.counters["bytes_per_point"] = work.resident / work.points();
  state.counters["pressure_iterations"] = Counter(iterations, Counter::kAvgIterations);
  for (std::size_t k = 0; k < kPhaseNames.size(); ++k)
    state.counters[std::string("s_per_step ") + kPhaseNames[k]] =
        Counter(work.phase_seconds()[k] - before[k], Counter::kAvgIterations);
  for (const auto& [part, bytes] : work.allocated()) state.counters["bytes " + part] = bytes;
}

void measure(benchmark::State& state, Workload& work, int threads) {
  const PhaseSeconds before = work.phase_seconds();
  double point_steps = 0, iterations = 0;
  const double cpu = cpu_seconds();
  with_threads(threads, [&] {
    for (auto _ : state) {
      iterations += work.step().iterations;
      point_steps += work.points();
    }
  });
  report(state, work, before, point_steps, iterations, cpu_seconds() - cpu);
}

void add_step(Kind kind, const SceneSize& size, double point_steps) {
  const std::string scene = scene_name(kind, size.dimensions);
  const std::string group = "step/" + scene + "/points:" + std::to_string(static_cast<long>(size.points));
  const long steps = std::lround(std::clamp(point_steps / size.points, kFewestSteps, kMostSteps));
  for (int threads : {1, 2})
    benchmark::RegisterBenchmark((group + "/threads:" + std::to_string(threads)).c_str(),
                                 [=](benchmark::State& state) {
                                   Workload& work =
                                       kept_workload(group, group, [&] { return make_scene(kind, size); });
                                   measure(state, work, threads);
                                   report_least_work(state, kind, size.dimensions);
                                 })
        ->Iterations(steps)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
}

void add_room(Kind kind) {
  const std::string group =
      "room/" + scene_name(kind, 2) + "/points:" + std::to_string(static_cast<long>(kRoomPoints));
  for (int room : {1, 10}) {
    const std::string name = group + "/room:" + std::to_string(room);
    benchmark::RegisterBenchmark(name.c_str(),
                                 [=](benchmark::State& state) {
                                   Workload& work = kept_workload(group, name, [&] {
                                     return make_scene(kind, {2, kRoomPoints, room});
                                   });
                                   measure(state, work, 1);
                                 })
        ->Iterations(kRoomSteps)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace

void register_steps(double point_steps) {
  for (const NamedKind& k : kinds()) {
    for (double points : {1e4, 1e5, 1e6, 4e6}) add_step(k.kind, {2, points, 1}, point_steps);
    for (double points : {1e5, 1e6}) add_step(k.kind, {3, points, 1}, point_steps);
    add_room(k.kind);
  }
}

}  // namespace quicksand::bench
