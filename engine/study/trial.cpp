#include "engine/study/trial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/plan/quasi_static.hpp"
#include "engine/run/event_times.hpp"
#include "engine/run/run.hpp"
#include "engine/scene/check.hpp"
#include "engine/study/cpu_time.hpp"
#include "engine/study/history.hpp"

namespace quicksand {
namespace {

class TrialMonitor final : public RunMonitor {
 public:
  TrialMonitor(Trial& trial, double longest, const std::function<bool()>& stopped)
      : trial_(trial), longest_(longest), stopped_(stopped) {}
  void situation(std::size_t stage, double time, const StepSituation& now) override {
    if (trial_.moments.empty()) first_ = cpu_seconds();
    auto& moments = trial_.moments;
    while (!moments.empty() && moments.back().time >= time) moments.pop_back();  // the run was taken back
    moments.push_back({stage, time, now});
    last_ = cpu_seconds();
    ++steps_;
  }
  bool cancelled() override { return cpu_seconds() - created_ > longest_ || (stopped_ && stopped_()); }
  /// s, of a step; the last one is not counted.
  double per_step() const { return steps_ > 1 ? (last_ - first_) / static_cast<double>(steps_ - 1) : 0; }
  double seconds() const { return cpu_seconds() - created_; }

 private:
  Trial& trial_;
  double longest_, created_ = cpu_seconds(), first_ = 0, last_ = 0;
  const std::function<bool()>& stopped_;
  long steps_ = 0;
};

struct Choice {
  Scene scene;
  Plan plan;
};

/// The scene on cells that fit it and for which it should take at most `budget` seconds.
std::optional<Choice> on_larger_cells(const Scene& scene, const Calibration& machine, double budget) {
  constexpr double ratios[] = {2, 2.5, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 1.5, 4.0 / 3, 1.25, 1};
  Choice choice{scene, {}};
  Scene& s = choice.scene;
  s.numerics.error_estimate = ErrorEstimate::none;
  double end = 0;
  for (const Stage& stage : scene.stages) end += stage.duration;
  s.output.frame_interval = s.output.series_interval = end;  // steps as they are without events
  for (const double ratio : ratios) {
    s.numerics.cell_size_factor = scene.numerics.cell_size_factor * ratio;
    if (!check(s).empty()) continue;
    choice.plan = make_plan(s, machine);
    if (choice.plan.seconds <= budget) return choice;
  }
  return {};
}

double soil_limit(const Plan& plan) {
  for (const StepBound& bound : plan.bounds)
    if (bound.name == "soil wave") return bound.seconds;
  return std::numeric_limits<double>::infinity();
}

double count_of(const Plan& plan) { return static_cast<double>(plan.soil_points + plan.water_points); }

/// Durations of the stages that the trial came through to their end.
std::vector<double> durations_of(const Trial& trial, const RunReport& report) {
  std::vector<double> durations;
  for (std::size_t k = 0; k < trial.moments.size(); ++k) {
    const std::size_t stage = trial.moments[k].stage;
    std::size_t next = k;
    while (next < trial.moments.size() && trial.moments[next].stage == stage) ++next;
    const bool last = next == trial.moments.size();
    if (last && report.status != RunStatus::succeeded) break;
    durations.resize(stage + 1, 0.0);
    durations[stage] = (last ? report.sim_time : trial.moments[next].time) - trial.moments[k].time;
    k = next - 1;
  }
  return durations;
}

/// The situation of a trial as it would be on the scene's own cells: bounds of waves by the size of the cells
/// and what inertia is scaled by, speeds as they are.
StepSituation scaled(const StepSituation& on_trial, double cells, double limits, double inertia) {
  StepSituation now = on_trial;
  const double slower = std::sqrt(inertia / on_trial.inertia);
  now.soil_limit *= limits * slower;
  now.fast_wave_limit *= cells * slower;
  now.inertia = inertia;
  return now;
}

struct Walk {
  double steps = 0, end = 0;  ///< –, s
};

/// Steps after which the rest is taken to be as what came before.
constexpr double kLongestWalk = 2e7;

Walk walk(const Trial& trial, const Scene& scene, double cells, double limits) {
  Walk done;
  std::size_t k = 0;
  double frame = 0, sample = 0, whole = 0;
  const auto& moments = trial.moments;
  for (std::size_t stage = 0; stage < scene.stages.size(); ++stage)
    whole += stage < trial.durations.size() ? trial.durations[stage] : scene.stages[stage].duration;
  for (std::size_t stage = 0; stage < scene.stages.size(); ++stage) {
    const double begin = done.end, inertia = slow_process(scene, stage).inertia;
    const double duration =
        stage < trial.durations.size() ? trial.durations[stage] : scene.stages[stage].duration;
    while (k + 1 < moments.size() && moments[k].stage < stage) ++k;
    double dt = 0;
    std::size_t known = moments.size();
    while (begin + duration - done.end > kTimeRounding * duration) {
      while (k + 1 < moments.size() && moments[k + 1].stage <= stage && moments[k + 1].time <= done.end) ++k;
      if (k != known) dt = choose_step(scene, scaled(moments[k].situation, cells, limits, inertia)).seconds;
      known = k;
      const double next_frame = next_event(frame, scene.output.frame_interval),
                   next_sample = next_event(sample, scene.output.series_interval);
      done.end += until(std::min({begin + duration, next_frame, next_sample}), done.end, dt);
      if (done.end >= next_frame * (1 - kTimeRounding)) frame = done.end;
      if (done.end >= next_sample * (1 - kTimeRounding)) sample = done.end;
      if (++done.steps >= kLongestWalk) return {done.steps * whole / done.end, whole};
    }
    done.end = begin + duration;
  }
  return done;
}

}  // namespace

Trial make_trial(const Scene& scene, const Calibration& machine, double budget,
                 const std::function<bool()>& stopped) {
  Trial trial;
  const auto choice = on_larger_cells(scene, machine, budget);
  if (!choice) {
    trial.missing = "no larger cells fit the scene and take at most " + std::to_string(budget) + " s";
    return trial;
  }
  TrialMonitor monitor(trial, 2 * budget, stopped);
  HistorySink nowhere;
  const RunReport report = run(choice->scene, nowhere, monitor, {1});
  if (report.status == RunStatus::failed || trial.moments.empty()) {
    trial.missing = "a run on cells of " + std::to_string(choice->plan.cell_size) + " m failed";
    return trial;
  }
  const double whole = choice->plan.end_time;
  trial.figures = {choice->plan.cell_size, report.steps, monitor.seconds(),
                   report.status == RunStatus::succeeded ? 1 : report.sim_time / whole};
  trial.soil_limit = soil_limit(choice->plan);
  trial.durations = durations_of(trial, report);
  const double expected = machine.seconds(scene, 1, count_of(choice->plan));
  if (monitor.per_step() > 0) trial.dearness = monitor.per_step() / expected;
  return trial;
}

void foretell(const Trial& trial, const Scene& scene, const Calibration& machine, Plan& plan) {
  if (!trial.missing.empty()) {
    plan.reasons.push_back("No trial: " + trial.missing + ".");
    return;
  }
  const double cells = plan.cell_size / trial.figures.cell_size;
  const double limits = std::isfinite(trial.soil_limit) ? soil_limit(plan) / trial.soil_limit : cells;
  const Walk foretold = walk(trial, scene, cells, limits);
  const double points = count_of(plan);
  plan.seconds += trial.dearness * machine.seconds(scene, foretold.steps, points) -
                  machine.seconds(scene, plan.steps, points) + output_seconds(scene, plan, foretold.end) -
                  output_seconds(scene, plan, plan.end_time);
  plan.steps = foretold.steps;
  plan.trial = trial.figures;
}

}  // namespace quicksand
