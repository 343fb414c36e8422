#include "engine/study/tradeoff.hpp"

#include <algorithm>
#include <chrono>

#include "engine/plan/plan.hpp"
#include "engine/study/cpu_time.hpp"

namespace quicksand {
namespace {

/// A rung is repeated until it has taken this long or this often.
constexpr double kRepeatSeconds = 0.3;
constexpr int kRepeats = 5;
/// Part of the budget that a rung's repetitions may take.
constexpr double kRepeatShare = 0.02;
/// Part of a rung's estimated time that has to be left of the budget for it to be started.
constexpr double kWorthStarting = 0.7;

/// Passes a rung's progress on as that of the ladder, and stops it when the budget is spent.
class RungMonitor final : public RunMonitor {
 public:
  struct Part {
    double begin = 0, share = 1;  ///< of the whole ladder's time
    std::chrono::steady_clock::time_point start;
  };
  RungMonitor(RunMonitor& monitor, int threads, double until, std::string stage, const Part& part)
      : monitor_(monitor), threads_(threads), until_(until), stage_(std::move(stage)), part_(part) {}
  void progress(const Progress& now) override {
    furthest_ = std::max(furthest_, now.fraction);  // a repetition begins again
    Progress shown = now;
    shown.stage = stage_;
    shown.fraction = part_.begin + part_.share * furthest_;
    shown.frames = 0;
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - part_.start;
    shown.eta_s = shown.fraction > 0 ? taken.count() * (1 - shown.fraction) / shown.fraction : 0;
    monitor_.progress(shown);
  }
  bool cancelled() override { return monitor_.cancelled() || (until_ > 0 && cpu_seconds(threads_) > until_); }
  bool suspended() override { return monitor_.suspended(); }

 private:
  RunMonitor& monitor_;
  int threads_;
  double until_;
  std::string stage_;
  Part part_;
  double furthest_ = 0;
};

/// What a figure's error is counted by.
double scale_of(const Curve& figure, const std::vector<Curve>& all) {
  const auto kind = [](const Curve& c) { return c.name.substr(0, c.name.find('.')); };
  double largest = 0;
  for (const Curve& other : all)
    if (kind(other) == kind(figure) && other.unit == figure.unit) largest = std::max(largest, other.range());
  return largest;
}

struct Run {
  RungResult result;
  std::vector<Curve> curves;
  RunStatus status = RunStatus::succeeded;
};

/// Once; on success with its curves.
void run_once(const Rung& rung, int threads, RunMonitor& monitor, Run& run) {
  HistorySink sink;
  const double before = cpu_seconds(threads);
  const RunReport report = quicksand::run(rung.scene, sink, monitor, {threads});
  const double taken = cpu_seconds(threads) - before;
  const bool first = run.curves.empty();
  run.result.cpu_seconds = first ? taken : std::min(taken, run.result.cpu_seconds);
  run.result.steps = static_cast<double>(report.steps);
  run.result.point_steps = report.point_steps;
  run.status = report.status;
  if (report.status == RunStatus::failed) run.result.missing = "failed: " + report.failure.code;
  if (report.status == RunStatus::succeeded && first)
    run.curves = sink.curves(rung.scene.domain.dimension == Dimension::space ? 3 : 2);
}

Run measure(const Rung& rung, const Plan& plan, int threads, double until, double repeat,
            RunMonitor& monitor) {
  Run run;
  run.result.factor = rung.factor;
  run.result.setting = rung.setting;
  run.result.memory_bytes = plan.memory_bytes;
  if (until > 0 && cpu_seconds(threads) + kWorthStarting * plan.seconds > until) {
    run.result.missing = "not run: over the budget";
    return run;
  }
  const double begin = cpu_seconds(threads);
  for (int k = 0; k < kRepeats && (k == 0 || cpu_seconds(threads) - begin < repeat); ++k) {
    Run again = run;
    run_once(rung, threads, monitor, again);
    if (k > 0 && again.status != RunStatus::succeeded) break;  // the budget ended a repetition
    run = std::move(again);
    if (run.status != RunStatus::succeeded) break;
  }
  if (run.status == RunStatus::canceled) run.result.missing = "stopped: over the budget";
  return run;
}

/// The run with most point-steps of the scene's own equations: other water and other forms are no finer.
Run* finest(std::vector<Run>& runs) {
  Run* best = nullptr;
  for (Run& run : runs)
    if (run.result.missing.empty() && (run.result.factor == "cell size" || run.result.factor == "as given"))
      if (!best || run.result.point_steps > best->result.point_steps) best = &run;
  return best;
}

}  // namespace

double error_against(const std::vector<Curve>& curves, const std::vector<Curve>& reference) {
  double largest = 0;
  for (const Curve& truth : reference)
    for (const Curve& own : curves)
      if (own.name == truth.name && own.component == truth.component)
        if (const double scale = scale_of(truth, reference); scale > 0)
          largest = std::max(largest, distance(truth, own) / scale);
  return largest;
}

void mark_front(std::vector<RungResult>& rungs) {
  constexpr double noise = 0.95;
  std::vector<RungResult*> by_cost;
  for (RungResult& rung : rungs) {
    rung.on_front = false;
    if (rung.missing.empty() && !rung.reference) by_cost.push_back(&rung);
  }
  std::stable_sort(by_cost.begin(), by_cost.end(),
                   [](const auto* a, const auto* b) { return a->cpu_seconds < b->cpu_seconds; });
  std::vector<RungResult*> front;
  for (RungResult* rung : by_cost) {
    if (!front.empty() && rung->error >= noise * front.back()->error) continue;
    while (!front.empty() && front.back()->cpu_seconds > noise * rung->cpu_seconds) front.pop_back();
    front.push_back(rung);
  }
  for (RungResult* rung : front) rung->on_front = true;
}

TradeoffCost tradeoff_cost(const Scene& scene, double budget, const Calibration& machine) {
  TradeoffCost cost;
  for (const Rung& rung : ladder(scene)) {
    const Plan plan = make_plan(rung.scene, machine);
    if (budget > 0 && cost.seconds + kWorthStarting * plan.seconds > budget) continue;
    cost.seconds += std::max(plan.seconds, std::min(kRepeatSeconds, kRepeats * plan.seconds));
    cost.memory_bytes = std::max(cost.memory_bytes, plan.memory_bytes);
    cost.points = std::max(cost.points, plan.soil_points + plan.fixed_soil_points + plan.water_points);
  }
  return cost;
}

Tradeoff measure_tradeoff(const Scene& scene, const std::vector<Curve>& reference, int threads, double budget,
                          RunMonitor& monitor) {
  const double until = budget > 0 ? cpu_seconds(threads) + budget : 0;
  const std::vector<Rung> rungs = ladder(scene);
  std::vector<Plan> plans;
  double all = 0, done = 0;
  for (const Rung& rung : rungs) plans.push_back(make_plan(rung.scene)), all += plans.back().seconds;
  const auto start = std::chrono::steady_clock::now();
  const double repeat = budget > 0 ? std::min(kRepeatSeconds, kRepeatShare * budget) : kRepeatSeconds;
  Tradeoff tradeoff;
  std::vector<Run> runs;
  for (std::size_t k = 0; k < rungs.size() && tradeoff.status == RunStatus::succeeded; ++k) {
    const std::string stage = std::to_string(k + 1) + " of " + std::to_string(rungs.size()) + ": " +
                              rungs[k].factor + " " + rungs[k].setting;
    RungMonitor passing(monitor, threads, until, stage, {done / all, plans[k].seconds / all, start});
    runs.push_back(measure(rungs[k], plans[k], threads, until, repeat, passing));
    done += plans[k].seconds;
    if (monitor.suspended()) tradeoff.status = RunStatus::suspended;
    if (monitor.cancelled()) tradeoff.status = RunStatus::canceled;
    const RungResult& r = runs.back().result;
    monitor.log(stage + ": " + (r.missing.empty() ? std::to_string(r.cpu_seconds) + " s" : r.missing));
  }
  std::vector<Curve> truth = reference;
  tradeoff.reference = "the curves given";
  if (Run* best = finest(runs); reference.empty() && best) {
    truth = best->curves;
    best->result.reference = true;
    tradeoff.reference = "the run with cells of " + best->result.setting;
  }
  const bool comparable =
      std::any_of(truth.begin(), truth.end(), [](const Curve& c) { return c.range() > 0; });
  for (Run& run : runs) {
    run.result.reference = run.result.reference && comparable;
    if (!comparable && run.result.missing.empty()) run.result.missing = "nothing to compare: give a probe";
    if (run.result.missing.empty() && !run.result.reference)
      run.result.error = error_against(run.curves, truth);
    tradeoff.rungs.push_back(run.result);
  }
  mark_front(tradeoff.rungs);
  return tradeoff;
}

}  // namespace quicksand
