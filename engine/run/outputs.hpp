#pragma once
#include <chrono>
#include <utility>
#include <vector>

#include "engine/run/background_sink.hpp"
#include "engine/run/held_outputs.hpp"
#include "engine/run/run.hpp"

namespace quicksand {

/// When frames and samples are due, and their way to the sink: held back until the steps that made them are
/// good, then written beside the steps that follow.
class Outputs {
 public:
  Outputs(const Output& wanted, ResultSink& sink) : wanted_(wanted), sink_(sink) {}

  void begin(const std::vector<SeriesInfo>& series) { sink_.begin(series); }
  bool sample_due(double time) const { return due(time, last_sample_, wanted_.series_interval); }
  bool frame_due(double time) const { return due(time, last_frame_, wanted_.frame_interval); }
  /// A step from `now`, shortened so that it ends on the next frame, sample or end of the stage; two equal
  /// steps rather than a sliver.
  double until_event(double now, double dt, double stage_end) const;

  /// `make` is called at once and gives the values; not when the sample of this time is there already.
  template <class Make>
  void sample(double time, Make&& make) {
    const Timed timed(seconds_);
    if (last_sample_ >= time && samples_ > 0) return;
    held_.sample(time, make());
    ++samples_;
    last_sample_ = time;
  }
  /// Likewise; `make` is given the frame's index.
  template <class Make>
  void frame(double time, Make&& make) {
    const Timed timed(seconds_);
    if (last_frame_ >= time && frames_ > 0) return;
    held_.frame(make(frames_));
    ++frames_;
    last_frame_ = time;
  }

  std::size_t frames() const { return frames_; }
  std::size_t samples() const { return samples_; }
  std::size_t held_frames() const { return held_.frames(); }
  /// That the sink has, those of the run that was resumed included.
  std::size_t frames_written() const { return frames_before_ + sink_.frames_written(); }
  double& seconds() { return seconds_; }  ///< wall time that all this has taken

  /// What is held back passes on.
  void release() {
    const Timed timed(seconds_);
    held_.release(sink_);
  }
  void drop() { held_.drop(); }
  void store(const Checkpoint& checkpoint) { sink_.checkpoint(checkpoint); }
  /// All has been written when it returns.
  void finish() {
    const Timed timed(seconds_);
    sink_.finish();
  }

  /// After a checkpoint was loaded: what it counts is there already.
  void go_on_from_here() { frames_before_ = frames_; }
  template <class A>
  void keep(A& a) {
    a(last_frame_, last_sample_, frames_, samples_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  /// Counts its own lifetime.
  struct Timed {
    explicit Timed(double& seconds) : seconds_(seconds) {}
    ~Timed() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
    double& seconds_;
    Clock::time_point start_ = Clock::now();
  };
  static bool due(double time, double last, double interval);

  const Output& wanted_;
  BackgroundSink sink_;
  HeldOutputs held_;
  double last_frame_ = 0, last_sample_ = 0;  ///< s
  std::size_t frames_ = 0, samples_ = 0, frames_before_ = 0;
  double seconds_ = 0;
};

}  // namespace quicksand
