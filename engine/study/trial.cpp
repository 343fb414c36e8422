#include "engine/study/trial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/plan/quasi_static.hpp"
#include "engine/run/event_times.hpp"
#include "engine/run/run.hpp"
#include "engine/scene/check.hpp"
#include "engine/scene/text.hpp"
#include "engine/study/cpu_time.hpp"
#include "engine/study/history.hpp"

namespace quicksand {
namespace {

class TrialMonitor final : public RunMonitor {
 public:
  TrialMonitor(std::vector<Moment>& moments, double longest, const std::function<bool()>& stopped)
      : moments_(moments), longest_(longest), stopped_(stopped) {}
  void situation(std::size_t stage, double time, const StepSituation& now) override {
    while (!moments_.empty() && moments_.back().time >= time) moments_.pop_back();  // the run was taken back
    moments_.push_back({stage, time, now});
    begun_.push_back({time, cpu_seconds()});
  }
  bool cancelled() override { return seconds() > longest_ || was_stopped(); }
  bool was_stopped() const { return stopped_ && stopped_(); }
  double seconds() const { return cpu_seconds() - created_; }
  /// s, of a step in the mean of those begun up to `time`, five at least; the last one of all is not counted.
  /// 0 if there are none.
  double per_step(double time) const {
    std::size_t steps = 0;
    while (steps + 1 < begun_.size() && (begun_[steps].time <= time || steps < 5)) ++steps;
    return steps ? (begun_[steps].clock - begun_[0].clock) / static_cast<double>(steps) : 0;
  }

 private:
  struct Begun {
    double time, clock;  ///< s, simulated and of the processor
  };
  std::vector<Moment>& moments_;
  std::vector<Begun> begun_;
  double longest_, created_ = cpu_seconds();
  const std::function<bool()>& stopped_;
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

namespace {

/// Whether a run comes to some steps within so many seconds.
bool is_seen_within(double seconds, const Scene& scene, const Plan& plan, const Calibration& machine) {
  constexpr double some = 10;
  const double points = count_of(plan) + static_cast<double>(plan.fixed_soil_points);
  return points * machine.output.seed_point + machine.seconds(scene, some, count_of(plan)) < seconds;
}

/// The scene without its companions, and without its frames where samples are taken at the same times: what
/// frames cost is told apart (output_seconds).
Scene bare(Scene scene) {
  scene.numerics.error_estimate = ErrorEstimate::none;
  Output& output = scene.output;
  const double samples = output.frame_interval / output.series_interval;
  double end = 0;
  for (const Stage& stage : scene.stages) end += stage.duration;
  if (std::abs(samples - std::round(samples)) < 1e-6 * samples)
    output.frame_interval = std::max(end, output.frame_interval);
  return scene;
}

/// One run of a trial.
struct Attempt {
  Trial trial;
  TrialMonitor monitor;
  RunReport report;
  bool stopped = false;  ///< by the caller

  Attempt(const Scene& scene, const Plan& plan, double longest, const std::function<bool()>& stop)
      : monitor(trial.moments, longest, stop) {
    HistorySink nowhere;
    report = run(scene, nowhere, monitor, {1});
    stopped = monitor.was_stopped();
    trial.figures = {plan.cell_size, report.steps, monitor.seconds(),
                     report.status == RunStatus::succeeded ? 1 : report.sim_time / plan.end_time};
    trial.soil_limit = soil_limit(plan);
    trial.durations = durations_of(trial, report);
  }
  bool failed() const { return report.status == RunStatus::failed || trial.moments.empty(); }
  bool is_whole() const { return report.status == RunStatus::succeeded; }
  double per_step(double time = std::numeric_limits<double>::infinity()) const {
    return monitor.per_step(time);
  }
};

/// Seconds of `steps` steps of a scene: by what they took in the trial on the scene's cells, by two sizes, or
/// by the calibration and what one size took.
double seconds_of(const Trial& trial, const Scene& scene, const Calibration& machine, double steps,
                  double points) {
  const Pace &own = trial.own, &larger = trial.larger;
  if (own.step > 0 && larger.step > 0 && own.points > larger.points) {
    double point = std::max(0.0, (own.step - larger.step) / (own.points - larger.points));
    point = std::min(point, own.step / own.points);  // a step does not take less than nothing
    return steps * (own.step + point * (points - own.points));
  }
  const Pace& one = own.step > 0 ? own : larger;
  const double dearness = one.step > 0 ? one.step / machine.seconds(scene, 1, one.points) : 1;
  return dearness * machine.seconds(scene, steps, points);
}

}  // namespace

Trial make_trial(const Scene& scene, const Calibration& machine, double budget,
                 const std::function<bool()>& stopped) {
  const double half = 0.5 * budget;
  const Scene itself = bare(scene);
  const Plan plan = make_plan(itself, machine);
  std::optional<Attempt> own;
  if (is_seen_within(half, itself, plan, machine)) own.emplace(itself, plan, half, stopped);
  const bool seen = own && !own->failed();
  if (seen) {
    own->trial.own = {count_of(plan), own->per_step()};
    own->trial.is_whole = own->is_whole();
    if (own->is_whole() || own->stopped) return own->trial;
  }
  const auto choice = on_larger_cells(scene, machine, half);
  if (!choice && seen) return own->trial;  // better than nothing: what is left is taken to go on as it ended
  if (!choice) {
    Trial none;
    none.missing = "no larger cells fit the scene and take at most " + text(half) + " s";
    return none;
  }
  Attempt larger(choice->scene, choice->plan, 2 * half, stopped);
  Trial& trial = larger.trial;
  if (larger.failed() && seen) return own->trial;
  if (larger.failed()) {
    trial.missing = "a run on cells of " + text(choice->plan.cell_size) + " m failed";
    return trial;
  }
  trial.larger = {count_of(choice->plan), larger.per_step()};
  if (!seen) return trial;
  trial.figures.seconds += own->monitor.seconds();
  const double begin = larger.per_step(own->report.sim_time);
  if (begin > 0) trial.own = {count_of(plan), own->per_step() * trial.larger.step / begin};
  return trial;
}

void foretell(const Trial& trial, const Scene& scene, const Calibration& machine, Plan& plan) {
  if (!trial.missing.empty()) {
    plan.reasons.push_back("No trial: " + trial.missing + ".");
    return;
  }
  const double cells = plan.cell_size / trial.figures.cell_size;
  const double limits = std::isfinite(trial.soil_limit) ? soil_limit(plan) / trial.soil_limit : cells;
  Walk foretold = walk(trial, scene, cells, limits);
  if (trial.is_whole && cells == 1) foretold.steps = static_cast<double>(trial.figures.steps);
  const double points = count_of(plan);
  plan.seconds += seconds_of(trial, scene, machine, foretold.steps, points) -
                  machine.seconds(scene, plan.steps, points) +
                  output_seconds(scene, plan, foretold.end, machine) -
                  output_seconds(scene, plan, plan.end_time, machine);
  plan.steps = foretold.steps;
  plan.trial = trial.figures;
}

}  // namespace quicksand
