#pragma once
// The queue's workers: each takes the run whose turn it is, executes it in `<runs>/<id>` and records its end.
// One more thread watches what the runs take and removes old results.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "server/change_bell.hpp"
#include "server/metrics.hpp"
#include "server/settings.hpp"
#include "server/state_folder.hpp"
#include "server/store.hpp"

namespace quicksand {

class Runner {
 public:
  Runner(Store& store, const StateFolder& folder, ChangeBell& bell, Metrics& metrics,
         const Settings& settings);
  ~Runner();  ///< stops and waits for the workers

  /// Brings order into what a killed server left, then starts the workers. Call once.
  void start();
  /// A run has been queued.
  void wake();
  /// Cancels within one step of the run. Empty when there is no such run; harmless on ended ones.
  std::optional<StoredRun> cancel(const std::string& id);
  /// Why nothing more may be written, the files of unfinished runs counted; empty when there is room.
  std::string shortage();

  /// Interrupts all runs and queues them again, so that the next start computes them.
  void begin_stop();
  /// True when all workers have ended in time. Otherwise what still runs is marked as queued in the store
  /// and the process should exit without waiting for it.
  bool wait_stopped(std::chrono::milliseconds patience);

 private:
  struct Active {
    StoredRun run;
    std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
    std::atomic<bool> cancel{false}, suspend{false};
    std::atomic<double> computed_s{0};  ///< wall time, before interruptions included
    std::optional<Failure> limit;  ///< guarded by mutex_; why it is ended or suspended, when a limit asks
  };
  struct End {
    RunState state = RunState::failed;  ///< queued: it goes on later
    std::optional<Failure> failure;     ///< of a queued one: what it waits for
  };

  // runner.cpp
  void work(bool short_runs_only);
  std::shared_ptr<Active> take_next(bool short_runs_only);
  ClaimRules claim_rules(bool short_runs_only) const;
  void execute_one(Active& active);
  End compute(Active& active);
  void record(Active& active, End end);
  void queue_again(Active& active, const End& end);

  // runner_guard.cpp
  void recover();
  void plan_what_waits();
  void guard();
  void enforce_limits();
  void expire_results();
  void end_for(Active& active, const Failure& failure);

  // runner_room.cpp
  std::string shortage_now();
  bool has_room();
  void tell_of_room(const std::string& shortage);
  void suspend_without_room();
  void pause_for(const Failure& failure);
  void keep_what_canceled_runs_left(std::unique_lock<std::mutex>& lock);

  Store& store_;
  const StateFolder& folder_;
  ChangeBell& bell_;
  Metrics& metrics_;
  const Settings& settings_;
  std::mutex mutex_;  ///< guards active_, running_workers_ and the order of claim and cancel
  std::condition_variable wake_, stopped_;
  std::map<std::string, std::shared_ptr<Active>> active_;
  std::set<std::string> begun_;      ///< queued runs that have files already
  std::set<std::string> left_over_;  ///< of begun_, those that were canceled since
  int running_workers_ = 0;
  bool waits_for_room_ = false;
  std::string lacked_;             ///< what the last run stopped for that found the disk full or read-only
  std::chrono::seconds pause_{0};  ///< before the queue tries again after that
  std::chrono::steady_clock::time_point try_again_{};
  std::atomic<bool> stopping_{false};
  std::vector<std::thread> workers_;
};

}  // namespace quicksand
