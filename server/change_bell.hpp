#pragma once
#include <chrono>
#include <condition_variable>
#include <mutex>

namespace quicksand {

/// Rings whenever any run's record has changed; long polls wait on it. Thread-safe.
class ChangeBell {
 public:
  using Deadline = std::chrono::steady_clock::time_point;

  /// Take it before reading the record, so that no change falls between reading and waiting.
  long long mark() const {
    const std::lock_guard lock(mutex_);
    return rings_;
  }
  void ring() {
    {
      const std::lock_guard lock(mutex_);
      ++rings_;
    }
    rung_.notify_all();
  }
  /// From now on nobody waits any more: the server stops.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    rung_.notify_all();
  }
  /// True when it rang after `mark`; false at the deadline or when closed.
  bool wait_after(long long mark, Deadline deadline) const {
    std::unique_lock lock(mutex_);
    rung_.wait_until(lock, deadline, [&] { return closed_ || rings_ != mark; });
    return !closed_ && rings_ != mark;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable rung_;
  long long rings_ = 0;
  bool closed_ = false;
};

}  // namespace quicksand
