#include "engine/study/ladder.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "engine/plan/plan.hpp"
#include "engine/scene/check.hpp"
#include "engine/scene/stages.hpp"
#include "engine/scene/text.hpp"

namespace quicksand {
namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Stops a rung when the budget is spent.
class BudgetMonitor final : public RunMonitor {
 public:
  BudgetMonitor(RunMonitor& monitor, double until) : monitor_(monitor), until_(until) {}
  void progress(const Progress& now) override { monitor_.progress(now); }
  bool cancelled() override { return monitor_.cancelled() || (until_ > 0 && cpu_seconds() > until_); }

 private:
  RunMonitor& monitor_;
  double until_;
};

void vary_water(const Scene& scene, std::vector<Rung>& rungs) {
  const auto add = [&](const char* factor, std::string setting, auto change) {
    Rung rung{factor, std::move(setting), scene};
    change(rung.scene);
    rungs.push_back(std::move(rung));
  };
  if (scene.numerics.pressure == PressureScheme::implicit) {
    for (const double tolerance : {1e-4, 1e-8})
      add("pressure tolerance", text(tolerance),
          [&](Scene& s) { s.numerics.pressure_tolerance = tolerance; });
    if (scene.water.bulk_modulus)
      add("pressure", "explicit", [](Scene& s) { s.numerics.pressure = PressureScheme::explicit_scheme; });
  } else {
    add("pressure", "implicit", [](Scene& s) { s.numerics.pressure = PressureScheme::implicit; });
  }
  if (scene.water.bulk_modulus)
    for (const double part : {0.1, 0.01})
      add("water bulk modulus", text(part * *scene.water.bulk_modulus) + " Pa",
          [&](Scene& s) { s.water.bulk_modulus = part * *scene.water.bulk_modulus; });
}

}  // namespace

std::vector<Rung> ladder(const Scene& original) {
  Scene scene = original;
  scene.numerics.error_estimate = ErrorEstimate::none;
  double end = 0;
  for (const Stage& stage : scene.stages) end += stage.duration;
  scene.output.frame_interval = std::max(end, scene.output.frame_interval);
  const Numerics& own = scene.numerics;
  std::vector<Rung> rungs{{"as given", text(scene.cell_size()) + " m", scene}};
  const auto add = [&](const char* factor, std::string setting, auto change) {
    Rung rung{factor, std::move(setting), scene};
    change(rung.scene.numerics);
    rungs.push_back(std::move(rung));
  };
  for (const double ratio : {4.0, 3.0, 2.0, 1.5, 0.75, 0.5})
    add("cell size", text(ratio * scene.cell_size()) + " m",
        [&](Numerics& n) { n.cell_size_factor *= ratio; });
  for (const int points : {1, 2, 3})
    if (points != own.points_per_cell)
      add("points per cell", std::to_string(points), [&](Numerics& n) { n.points_per_cell = points; });
  add("kernel", own.kernel == Kernel::linear ? "quadratic" : "linear",
      [](Numerics& n) { n.kernel = n.kernel == Kernel::linear ? Kernel::quadratic : Kernel::linear; });
  add("transfer", own.transfer == Transfer::apic ? "flip" : "apic",
      [](Numerics& n) { n.transfer = n.transfer == Transfer::apic ? Transfer::flip : Transfer::apic; });
  for (const double part : {0.5, 0.25})
    add("time step", text(part) + " ×", [&](Numerics& n) {
      if (n.time_step) n.time_step = *n.time_step * part;
      n.time_step_factor *= part;
    });
  if (has_water(scene)) vary_water(scene, rungs);
  std::erase_if(rungs, [](const Rung& rung) { return !check(rung.scene).empty(); });
  return rungs;
}

namespace {

struct Run {
  RungResult result;
  std::vector<Curve> curves;
};

double error_against(const std::vector<Curve>& curves, const std::vector<Curve>& reference) {
  double largest = 0;
  for (const Curve& truth : reference)
    for (const Curve& own : curves)
      if (own.name == truth.name && own.component == truth.component && truth.range() > 0)
        largest = std::max(largest, distance(truth, own) / truth.range());
  return largest;
}

Run measure(const Rung& rung, int threads, double until, RunMonitor& monitor) {
  Run run;
  run.result.factor = rung.factor;
  run.result.setting = rung.setting;
  const Plan plan = make_plan(rung.scene);
  run.result.memory_bytes = plan.memory_bytes;
  if (until > 0 && cpu_seconds() + 0.7 * plan.seconds > until) {
    run.result.missing = "not run: over the budget";
    return run;
  }
  HistorySink sink;
  BudgetMonitor bounded(monitor, until);
  const double before = cpu_seconds();
  const RunReport report = quicksand::run(rung.scene, sink, bounded, {threads});
  run.result.cpu_seconds = cpu_seconds() - before;
  run.result.steps = static_cast<double>(report.steps);
  run.result.point_steps = report.point_steps;
  if (report.status == RunStatus::canceled) run.result.missing = "stopped: over the budget";
  if (report.status == RunStatus::failed) run.result.missing = "failed: " + report.failure.code;
  if (run.result.missing.empty()) run.curves = sink.curves(plan.dimensions);
  return run;
}

void mark_front(std::vector<RungResult>& rungs) {
  for (RungResult& rung : rungs)
    rung.on_front = rung.missing.empty() && !rung.reference &&
                    std::none_of(rungs.begin(), rungs.end(), [&](const RungResult& other) {
                      return other.missing.empty() && !other.reference && other.error < rung.error &&
                             other.cpu_seconds < rung.cpu_seconds;
                    });
}

}  // namespace

Tradeoff measure_tradeoff(const Scene& scene, const std::vector<Curve>& reference, int threads, double budget,
                          RunMonitor& monitor) {
  const double until = budget > 0 ? cpu_seconds() + budget : 0;
  std::vector<Run> runs;
  for (const Rung& rung : ladder(scene)) runs.push_back(measure(rung, threads, until, monitor));
  Tradeoff tradeoff;
  std::vector<Curve> truth = reference;
  tradeoff.reference = "the curves given";
  if (reference.empty()) {
    const auto finest = std::max_element(runs.begin(), runs.end(), [](const Run& a, const Run& b) {
      const auto work = [](const Run& r) {  // other water and other forms of the equations are no finer
        const bool counts =
            r.result.missing.empty() && (r.result.factor == "cell size" || r.result.factor == "as given");
        return counts ? r.result.point_steps : -1;
      };
      return work(a) < work(b);
    });
    if (finest->result.missing.empty()) {
      truth = finest->curves;
      finest->result.reference = true;
      tradeoff.reference = "the run with cells of " + finest->result.setting;
    }
  }
  for (Run& run : runs) {
    if (run.result.missing.empty()) run.result.error = error_against(run.curves, truth);
    tradeoff.rungs.push_back(run.result);
  }
  mark_front(tradeoff.rungs);
  return tradeoff;
}

}  // namespace quicksand
