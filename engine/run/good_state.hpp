#pragma once
#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "engine/run/archive.hpp"
#include "engine/run/run.hpp"

namespace quicksand {

/// The last state that a run can go back to, and go on from after it was interrupted.
class GoodState {
 public:
  explicit GoodState(const RunOptions& options) : options_(options) {}

  const Checkpoint& checkpoint() const { return last_; }
  bool due(long steps, std::size_t held_frames) const {
    return steps - step_ >= options_.good_every || held_frames >= kHeldFrames;
  }
  /// `keep` lists the run's state to a Saver.
  template <class Keep>
  void take(long steps, Checkpoint facts, Keep&& keep) {
    Saver to;
    to.bytes = std::move(last_.state);  // its memory
    to.bytes.clear();
    if (step_ < 0) reserve(to, keep);
    keep(to);
    last_ = std::move(facts);
    last_.state = std::move(to.bytes);
    step_ = steps;
  }
  /// It was gone back to, or `loaded`.
  void is_of(long steps) { step_ = steps; }
  void loaded(const Checkpoint& checkpoint) { last_ = checkpoint; }

  /// Whether it is time to store it.
  bool due_to_store() const {
    if (options_.checkpoint_interval <= 0) return false;
    return seconds(stored_, Clock::now()) >=
           std::clamp(seconds(start_, stored_), kFirstCheckpoint, options_.checkpoint_interval);
  }
  void stored() { stored_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;

  /// Room for the first state and a little more: one that grows as it is written takes three times as much.
  template <class Keep>
  static void reserve(Saver& to, Keep&& keep) {
    Saver counter;
    counter.only_counts = true;
    keep(counter);
    to.bytes.reserve(counter.count + counter.count / 16);
  }

  static double seconds(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
  }
  /// Frames that are held back at most: each takes about a third of a good state's memory.
  static constexpr std::size_t kHeldFrames = 4;
  /// s of wall time, before which nothing is worth a checkpoint.
  static constexpr double kFirstCheckpoint = 0.25;

  const RunOptions& options_;
  Checkpoint last_;
  long step_ = -1;  ///< steps that led to it; −1: there is none
  Clock::time_point start_ = Clock::now(), stored_ = start_;
};

}  // namespace quicksand
