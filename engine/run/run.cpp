#include "engine/run/run.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>

#include "engine/plan/step_bounds.hpp"
#include "engine/run/diagnosis.hpp"
#include "engine/run/easing.hpp"
#include "engine/run/first_limits.hpp"
#include "engine/run/frame.hpp"
#include "engine/run/good_state.hpp"
#include "engine/run/outputs.hpp"
#include "engine/run/setup.hpp"
#include "engine/run/snapshot.hpp"
#include "engine/run/soundness.hpp"
#include "engine/run/stage.hpp"
#include "engine/run/step_count.hpp"
#include "engine/run/time_rounding.hpp"
#include "engine/run/watch.hpp"
#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// One run from its first to its last step.
template <int D>
class Run {
 public:
  Run(const Scene& scene, ResultSink& sink, RunMonitor& monitor, const RunOptions& options)
      : options_(options),
        scene_(scene),
        monitor_(monitor),
        state_(make_state<D>(scene)),
        ledger_(scene, state_),
        watch_(scene),
        outputs_(scene.output, sink),
        good_(options) {
    for (const Stage& stage : scene.stages) end_time_ += stage.duration;
    limits_before_first_step(state_, last_);
    measure_motion(state_, last_);
    soundness_.emplace(scene_, state_, last_);
    if (options_.resume) load(*options_.resume);
  }

  RunReport go() {
    outputs_.begin(watch_.info());
    if (!options_.resume) {
      write_sample();
      write_frame();
    }
    for (; stage_ < scene_.stages.size(); ++stage_)
      if (!run_stage()) break;
    if (report_.status != RunStatus::suspended) show_end();
    finish();
    return report_;
  }

 private:
  /// False when the run has ended before its time.
  bool run_stage() {
    const Stage& stage = scene_.stages[stage_];
    if (!inside_stage_) begin_stage();
    const double end = stage_begin_ + stage.duration;
    while (end - state_.time > kTimeRounding * stage.duration) {
      if (monitor_.cancelled()) return stop(RunStatus::canceled);
      if (monitor_.suspended()) return suspend();
      if (count_.steps() >= scene_.numerics.max_steps) return fail(too_many_steps(scene_, state_.time));
      const StepSituation now = situation();
      monitor_.situation(stage_, state_.time, now);
      const StepBound bound = choose_step(scene_, now);
      if (const auto wave = outrun_wave(scene_, now, easing_.shortened(bound).seconds))
        return fail(unstable_step(scene_, state_, *wave));
      if (const auto failure = step(bound, end)) {
        if (!take_back(*failure)) return fail(*failure);
        continue;
      }
      if (stage.until_rest && rest_.rests(*stage.until_rest, last_.max_speed, state_.time - stage_begin_)) {
        monitor_.log("at rest after " + text(state_.time - stage_begin_) + " s");
        end_time_ -= end - state_.time;
        break;
      }
      if (good_.due(count_.steps(), outputs_.held_frames())) keep_good();
    }
    inside_stage_ = false;
    return true;
  }
  bool stop(RunStatus status) {
    report_.status = status;
    return false;
  }
  /// Everything of a run that lasts from one step to the next.
  template <class A>
  void keep(A& a) {
    a(stage_, inside_stage_, stage_begin_, end_time_, first_step_, rest_);
    a(ledger_, watch_, inertia_, *soundness_, last_, easing_, outputs_, count_);
  }
  /// Makes this state the one that is gone back to. What was held back until now is good, too.
  void keep_good() {
    easing_.came_through();
    outputs_.release();
    good_.take(count_.steps(), {"", outputs_.frames(), outputs_.samples(), state_.time}, [&](Saver& to) {
      keep(to);
      double wall = wall_before_ + seconds_since(start_);
      to(wall, outputs_.seconds());
      save_state(to, state_);
    });
    if (good_.due_to_store()) store_good();
  }
  /// Goes back to the last good state, to go on from it with shorter steps. False when that was tried before.
  bool take_back(const Failure& failure) {
    if (!easing_.shorten(options_.retries)) return false;
    const Easing easing = easing_;
    const long retries = state_.interventions.retries + 1;
    const auto phase_seconds = state_.phase_seconds;
    const double wall = wall_before_, output = outputs_.seconds();
    outputs_.drop();
    state_ = State<D>();  // its memory goes before the next one's comes
    state_ = make_state<D>(scene_);
    read(good_.checkpoint());
    easing_ = easing;
    state_.interventions.retries = retries;
    state_.phase_seconds = phase_seconds;
    wall_before_ = wall, outputs_.seconds() = output;
    monitor_.log(failure.message.substr(0, failure.message.find(". ")) + ". Back at t = " +
                 text(state_.time) + " s, with steps 1/" + text(1 / easing_.factor()) + " as long");
    return true;
  }

  void store_good() {
    outputs_.store(good_.checkpoint());
    good_.stored();
  }
  bool suspend() {
    outputs_.drop();
    store_good();
    return stop(RunStatus::suspended);
  }
  void read(const Checkpoint& checkpoint) {
    Loader from(checkpoint.state);
    keep(from);
    if (stage_ >= scene_.stages.size()) throw std::runtime_error("the checkpoint is of another case");
    from(wall_before_, outputs_.seconds());
    load_state(from, scene_, stage_, state_);
    if (!from.empty()) throw std::runtime_error("the checkpoint is of another case");
    good_.is_of(count_.steps());
  }
  void load(const Checkpoint& checkpoint) {
    read(checkpoint);
    good_.loaded(checkpoint);
    outputs_.go_on_from_here();
    monitor_.log("resumed at " + text(state_.time) + " s, step " + std::to_string(count_.steps()));
  }
  void begin_stage() {
    const std::size_t index = stage_;
    const double inertia = state_.constants.inertia;
    const StageChange<D> change = quicksand::begin_stage(scene_, index, state_);
    ledger_.add(change);
    if (change.removed.anything) {
      last_ = {};
      measure_motion(state_, last_);
    }
    if (change.removed.anything || state_.constants.inertia != inertia) {
      limits_before_first_step(state_, last_);
      first_step_ = 0;
    }
    inertia_.begin(scene_, index, state_.time);
    inside_stage_ = true;
    stage_begin_ = state_.time;
    rest_.begin();
    monitor_.log("stage " + scene_.stages[index].name + " begins at " + text(state_.time) + " s");
    keep_good();  // so that going back never leaves the stage
  }

  StepSituation situation() const {
    return {last_.soil_limit, last_.max_speed, state_.water.size() > 0, last_.fast_wave_limit,
            state_.constants.inertia};
  }

  /// What a shorter step may help against.
  std::optional<Failure> step(const StepBound& bound, double stage_end) {
    if (bound.seconds < kCollapse * first_step(bound.seconds))
      return collapsed_step(scene_, state_, bound, easing_.factor());
    const StepBound chosen = easing_.shortened(bound);
    last_ = advance(state_, outputs_.until_event(state_.time, chosen.seconds, stage_end));
    count_.add(last_.dt, last_.pressure.iterations, state_.soil.size() + state_.water.size(), chosen.name);
    if (!last_.finite) return not_finite(scene_, state_, easing_.factor());
    ledger_.add(state_, last_);
    inertia_.add(state_, last_);
    const bool look = outputs_.sample_due(state_.time) || !last_.pressure.converged;
    if (const auto bad = soundness_->add(state_, last_, ledger_.ledger(), look))
      return unsound(scene_, state_, *bad, easing_.factor());
    watch_.track(state_);
    if (!last_.pressure.converged)
      return pressure_not_found(scene_, state_, last_.pressure.residual, easing_.factor());
    if (outputs_.sample_due(state_.time)) write_sample();
    if (outputs_.frame_due(state_.time)) write_frame();
    report_progress(chosen.name);
    return {};
  }

  void write_sample() {
    outputs_.sample(state_.time, [&] {
      ledger_.measure(state_, last_);
      ledger_.sampled();
      soundness_->sampled(state_);
      return watch_.sample(state_, last_, ledger_.ledger());
    });
  }
  void write_frame() {
    outputs_.frame(state_.time,
                   [&](std::size_t index) { return make_frame(scene_, state_, index, stage_name()); });
  }
  void show_end() {
    if (last_.finite) write_sample();
    if (last_.finite) write_frame();
    outputs_.release();
  }

  void report_progress(const std::string& bound) {
    Progress p;
    p.sim_time = state_.time;
    p.end_time = end_time_;
    p.fraction = end_time_ > 0 ? std::min(1.0, state_.time / end_time_) : 1;
    p.stage = stage_name();
    p.step = count_.steps();
    p.time_step = last_.dt;
    p.bound = bound;
    p.frames = outputs_.frames_written();
    p.wall_seconds = wall_before_ + seconds_since(start_);
    p.eta_s = p.fraction > 0 ? p.wall_seconds * (1 - p.fraction) / p.fraction : 0;
    monitor_.progress(p);
  }

  bool fail(Failure failure) {
    report_.status = RunStatus::failed;
    report_.failure = std::move(failure);
    monitor_.log("failed: " + report_.failure.message);
    return false;
  }

  void finish() {
    outputs_.finish();
    ledger_.measure(state_, last_);
    report_.ledger = ledger_.ledger();
    const bool suspended = report_.status == RunStatus::suspended;
    if (!suspended) report_.cautions = soundness_->cautions(report_.ledger);
    for (const std::string& caution : report_.cautions) monitor_.log(caution);
    report_.heave = watch_.heave();
    report_.quasi_static = inertia_.reports();
    report_.frames = suspended ? good_.checkpoint().frames : outputs_.frames();
    report_.sim_time = state_.time;
    report_.wall_seconds = wall_before_ + seconds_since(start_);
    count_.tell(report_);
    for (std::size_t i = 0; i < kPhaseNames.size(); ++i)
      report_.phases.push_back({kPhaseNames[i], state_.phase_seconds[i]});
    report_.phases.push_back({"output", outputs_.seconds()});
  }

  double first_step(double dt) {
    if (first_step_ == 0) first_step_ = std::min(dt, scene_.output.frame_interval);
    return first_step_;
  }
  const std::string& stage_name() const {
    return scene_.stages[std::min(stage_, scene_.stages.size() - 1)].name;
  }
  static std::string text(double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.6g", value);
    return buffer;
  }

  /// A step this much shorter than the first one says that the state has run away.
  static constexpr double kCollapse = 1e-5;

  const RunOptions& options_;
  const Scene& scene_;
  RunMonitor& monitor_;
  State<D> state_;
  LedgerKeeper<D> ledger_;
  std::optional<Soundness<D>> soundness_;
  Watch<D> watch_;
  InertiaWatch inertia_;
  StepReport<D> last_;
  RunReport report_;
  Easing easing_;
  Outputs outputs_;
  GoodState good_;
  std::size_t stage_ = 0;
  bool inside_stage_ = false;
  double stage_begin_ = 0;                ///< s
  double end_time_ = 0, first_step_ = 0;  ///< s
  RestWatch rest_;
  StepCount count_;
  double wall_before_ = 0;  ///< s, of the run that was resumed
  Clock::time_point start_ = Clock::now();
};

template <int D>
RunReport run_in(const Scene& scene, ResultSink& sink, RunMonitor& monitor, const RunOptions& options) {
  return Run<D>(scene, sink, monitor, options).go();
}

}  // namespace

RunReport run(const Scene& scene, ResultSink& sink, RunMonitor& monitor, const RunOptions& options) {
  RunReport report;
  with_threads(options.threads, [&] {
    try {
      report = scene.domain.dimension == Dimension::space ? run_in<3>(scene, sink, monitor, options)
                                                          : run_in<2>(scene, sink, monitor, options);
    } catch (const std::exception& e) {
      report.status = RunStatus::failed;
      report.failure = {"output", e.what(), 0, {}};
      monitor.log(std::string("failed: ") + e.what());
    }
  });
  return report;
}

}  // namespace quicksand
