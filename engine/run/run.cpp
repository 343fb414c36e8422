#include "engine/run/run.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>

#include "engine/plan/step_bounds.hpp"
#include "engine/run/background_sink.hpp"
#include "engine/run/diagnosis.hpp"
#include "engine/run/easing.hpp"
#include "engine/run/frame.hpp"
#include "engine/run/held_outputs.hpp"
#include "engine/run/setup.hpp"
#include "engine/run/snapshot.hpp"
#include "engine/run/stage.hpp"
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
        sink_(sink),
        monitor_(monitor),
        state_(make_state<D>(scene)),
        ledger_(scene, state_),
        watch_(scene) {
    for (const Stage& stage : scene.stages) end_time_ += stage.duration;
    set_limits();
    measure_motion(state_, last_);
    if (options_.resume) load(*options_.resume);
  }

  RunReport go() {
    sink_.begin(watch_.info());
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
  /// Counts its own lifetime as output.
  struct OutputTime {
    explicit OutputTime(Run& run) : run_(run) {}
    ~OutputTime() { run_.output_seconds_ += seconds_since(start_); }
    Run& run_;
    Clock::time_point start_ = Clock::now();
  };

  /// False when the run has ended before its time.
  bool run_stage() {
    const Stage& stage = scene_.stages[stage_];
    if (!inside_stage_) begin_stage();
    const double end = stage_begin_ + stage.duration;
    while (end - state_.time > kTimeRounding * stage.duration) {
      if (monitor_.cancelled()) return stop(RunStatus::canceled);
      if (monitor_.suspended()) return suspend();
      if (report_.steps >= scene_.numerics.max_steps) return fail(too_many_steps(scene_, state_.time));
      const StepSituation now = situation();
      const StepBound bound = choose_step(scene_, now);
      if (const auto wave = outrun_wave(scene_, now, easing_.shortened(bound).seconds))
        return fail(unstable_step(scene_, state_, *wave));
      if (const auto failure = step(bound, end)) {
        if (!take_back(*failure)) return fail(*failure);
        continue;
      }
      if (comes_to_rest(stage)) {
        monitor_.log("at rest after " + text(state_.time - stage_begin_) + " s");
        end_time_ -= end - state_.time;
        break;
      }
      if (due_to_keep_good()) keep_good();
    }
    inside_stage_ = false;
    return true;
  }
  bool stop(RunStatus status) {
    report_.status = status;
    return false;
  }
  bool comes_to_rest(const Stage& stage) {
    if (!stage.until_rest) return false;
    rest_steps_ = last_.max_speed < stage.until_rest->speed ? rest_steps_ + 1 : 0;
    return rest_steps_ >= kRestSteps && state_.time - stage_begin_ >= stage.until_rest->at_least;
  }

  /// Everything of a run that lasts from one step to the next.
  template <class A>
  void keep(A& a) {
    a(stage_, inside_stage_, stage_begin_, rest_steps_);
    a(end_time_, last_frame_time_, last_sample_time_, first_step_, iterations_, bound_seconds_);
    a(ledger_, watch_, inertia_, last_, easing_);
    a(report_.steps, report_.point_steps, report_.time_step_min, report_.time_step_max, report_.frames,
      samples_);
  }
  /// Makes this state the one that is gone back to. What was held back until now is good, too.
  void keep_good() {
    easing_.came_through();
    release();
    Saver to;
    to.bytes = std::move(good_.state);
    to.bytes.clear();
    keep(to);
    double wall = wall_before_ + seconds_since(start_);
    to(wall, output_seconds_);
    save_state(to, state_);
    good_ = {std::move(to.bytes), report_.frames, samples_, state_.time};
    good_step_ = report_.steps;
    if (due_to_save()) save();
  }
  bool due_to_keep_good() const {
    return report_.steps - good_step_ >= options_.good_every || held_.frames() >= kHeldFrames;
  }
  /// Goes back to the last good state, to go on from it with shorter steps. False when that was tried before.
  bool take_back(const Failure& failure) {
    if (!easing_.shorten(options_.retries)) return false;
    const Easing easing = easing_;
    const long retries = state_.interventions.retries + 1;
    const auto phase_seconds = state_.phase_seconds;
    const double wall = wall_before_, output = output_seconds_;
    held_.drop();
    state_ = State<D>();  // its memory goes before the next one's comes
    state_ = make_state<D>(scene_);
    read(good_);
    easing_ = easing;
    state_.interventions.retries = retries;
    state_.phase_seconds = phase_seconds;
    wall_before_ = wall, output_seconds_ = output;
    monitor_.log(failure.message.substr(0, failure.message.find(". ")) + ". Back at t = " +
                 text(state_.time) + " s, with steps 1/" + text(1 / easing_.factor()) + " as long");
    return true;
  }

  void save() {
    sink_.checkpoint(good_);
    saved_ = Clock::now();
  }
  bool suspend() {
    held_.drop();
    save();
    report_.frames = good_.frames;
    return stop(RunStatus::suspended);
  }
  void read(const Checkpoint& checkpoint) {
    Loader from(checkpoint.state);
    keep(from);
    if (stage_ >= scene_.stages.size()) throw std::runtime_error("the checkpoint is of another case");
    from(wall_before_, output_seconds_);
    load_state(from, scene_, stage_, state_);
    if (!from.empty()) throw std::runtime_error("the checkpoint is of another case");
    good_step_ = report_.steps;
  }
  void load(const Checkpoint& checkpoint) {
    read(checkpoint);
    good_ = checkpoint;
    frames_before_ = report_.frames;
    monitor_.log("resumed at " + text(state_.time) + " s, step " + std::to_string(report_.steps));
  }
  bool due_to_save() const {
    if (options_.checkpoint_interval <= 0) return false;
    const double so_far = std::chrono::duration<double>(saved_ - start_).count();
    return seconds_since(saved_) >= std::clamp(so_far, kFirstCheckpoint, options_.checkpoint_interval);
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
      set_limits();
      first_step_ = 0;
    }
    inertia_.begin(scene_, index, state_.time);
    inside_stage_ = true;
    stage_begin_ = state_.time;
    rest_steps_ = 0;
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
    last_ = advance(state_, until_event(chosen.seconds, stage_end));
    ++report_.steps;
    report_.point_steps += static_cast<double>(state_.soil.size() + state_.water.size());
    report_.time_step_min = report_.steps == 1 ? last_.dt : std::min(report_.time_step_min, last_.dt);
    report_.time_step_max = std::max(report_.time_step_max, last_.dt);
    bound_seconds_[chosen.name] += last_.dt;
    iterations_ += last_.pressure.iterations;
    if (!last_.finite) return not_finite(scene_, state_, easing_.factor());
    ledger_.add(state_, last_);
    inertia_.add(state_, last_);
    watch_.track(state_);
    if (!last_.pressure.converged)
      return pressure_not_found(scene_, state_, last_.pressure.residual, easing_.factor());
    if (due(last_sample_time_, scene_.output.series_interval)) write_sample();
    if (due(last_frame_time_, scene_.output.frame_interval)) write_frame();
    report_progress(chosen.name);
    return {};
  }

  /// Shortens a step so that it ends on the next frame, sample or stage; two equal steps rather than a
  /// sliver.
  double until_event(double dt, double stage_end) const {
    double rest = stage_end - state_.time;
    for (const auto& [last, interval] : {std::pair{last_frame_time_, scene_.output.frame_interval},
                                         std::pair{last_sample_time_, scene_.output.series_interval}})
      rest = std::min(rest, next_event(last, interval) - state_.time);
    if (rest <= dt * (1 + kTimeRounding)) return rest;
    return rest < 2 * dt ? 0.5 * rest : dt;
  }
  static double next_event(double last, double interval) {
    return (std::floor(last / interval + kTimeRounding) + 1) * interval;
  }
  bool due(double last, double interval) const {
    return state_.time >= next_event(last, interval) - kTimeRounding * interval;
  }

  void write_sample() {
    const OutputTime timed(*this);
    ledger_.measure(state_, last_);
    held_.sample(state_.time, watch_.sample(state_, last_, ledger_.ledger()));
    ++samples_;
    last_sample_time_ = state_.time;
  }
  void write_frame() {
    const OutputTime timed(*this);
    held_.frame(make_frame(scene_, state_, report_.frames, stage_name()));
    ++report_.frames;
    last_frame_time_ = state_.time;
  }

  void release() {
    const OutputTime timed(*this);
    held_.release(sink_);
  }
  void show_end() {
    if (last_.finite && last_sample_time_ < state_.time) write_sample();
    if (last_.finite && last_frame_time_ < state_.time) write_frame();
    release();
  }

  void finish_output() {
    const OutputTime timed(*this);
    sink_.finish();
  }

  void report_progress(const std::string& bound) {
    Progress p;
    p.sim_time = state_.time;
    p.end_time = end_time_;
    p.fraction = end_time_ > 0 ? std::min(1.0, state_.time / end_time_) : 1;
    p.stage = stage_name();
    p.step = report_.steps;
    p.time_step = last_.dt;
    p.bound = bound;
    p.frames = frames_before_ + sink_.frames_written();
    const double wall = wall_before_ + seconds_since(start_);
    p.eta_s = p.fraction > 0 ? wall * (1 - p.fraction) / p.fraction : 0;
    monitor_.progress(p);
  }

  bool fail(Failure failure) {
    report_.status = RunStatus::failed;
    report_.failure = std::move(failure);
    monitor_.log("failed: " + report_.failure.message);
    return false;
  }

  void finish() {
    finish_output();
    ledger_.measure(state_, last_);
    report_.ledger = ledger_.ledger();
    report_.heave = watch_.heave();
    report_.quasi_static = inertia_.reports();
    report_.sim_time = state_.time;
    report_.wall_seconds = wall_before_ + seconds_since(start_);
    report_.pressure_iterations_mean = report_.steps ? iterations_ / static_cast<double>(report_.steps) : 0;
    for (const auto& [name, seconds] : bound_seconds_) report_.steps_bound_by.push_back({name, seconds});
    for (std::size_t i = 0; i < kPhaseNames.size(); ++i)
      report_.phases.push_back({kPhaseNames[i], state_.phase_seconds[i]});
    report_.phases.push_back({"output", output_seconds_});
  }

  /// Step limits of the soil before the first step tells them.
  void set_limits() {
    double limit = std::numeric_limits<double>::infinity(), fast_wave = limit;
    for (std::size_t p = 0; p < state_.soil.size(); ++p) {
      const int k = state_.soil.soil[p];
      const StepLimit& l = state_.constants.step_limits[k];
      const double n = state_.soil.porosity[p];
      const double modulus =
          state_.constants.soils[k].template constrained_modulus<D>(soil_state(state_.soil, p), n);
      const bool confined = state_.cell[state_.grid.index(state_.grid.cell_of(state_.soil.x[p]))].confined;
      limit = std::min(limit, confined ? l.saturated(n, modulus) : l.dry(n, modulus));
      if (state_.constants.explicit_pressure) fast_wave = std::min(fast_wave, l.fast_wave(n, modulus));
    }
    last_.soil_limit = limit;
    last_.fast_wave_limit = fast_wave;
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

  /// Part of an interval that counts as rounding of time.
  static constexpr double kTimeRounding = 1e-9;
  /// Steps in a row that must be slow before a stage counts as at rest: a wave crosses some 80 cells in them,
  /// and a load that has just begun or a turning point does not pass for rest.
  static constexpr long kRestSteps = 100;
  /// A step this much shorter than the first one says that the state has run away.
  static constexpr double kCollapse = 1e-5;

  /// Frames that are held back at most: each takes about a third of a good state's memory.
  static constexpr std::size_t kHeldFrames = 4;
  /// s of wall time, before which nothing is worth a checkpoint.
  static constexpr double kFirstCheckpoint = 0.25;

  const RunOptions& options_;
  const Scene& scene_;
  BackgroundSink sink_;
  RunMonitor& monitor_;
  State<D> state_;
  LedgerKeeper<D> ledger_;
  Watch<D> watch_;
  InertiaWatch inertia_;
  StepReport<D> last_;
  RunReport report_;
  Easing easing_;
  HeldOutputs held_;    ///< since the last good state
  Checkpoint good_;     ///< the last good state
  long good_step_ = 0;  ///< steps that led to it
  std::size_t stage_ = 0, samples_ = 0;
  bool inside_stage_ = false;
  double stage_begin_ = 0;  ///< s
  long rest_steps_ = 0;
  double end_time_ = 0, last_frame_time_ = 0, last_sample_time_ = 0, first_step_ = 0, iterations_ = 0;
  double output_seconds_ = 0;      ///< wall time
  double wall_before_ = 0;         ///< s, of the run that was resumed
  std::size_t frames_before_ = 0;  ///< that the sink had from it
  std::map<std::string, double> bound_seconds_;
  Clock::time_point start_ = Clock::now(), saved_ = start_;
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
