#pragma once
// The queue's workers: each takes the oldest queued run, executes it in `<runs>/<id>` and records its end.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
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

  /// Interrupts all runs and queues them again, so that the next start computes them.
  void begin_stop();
  /// True when all workers have ended in time. Otherwise what still runs is marked as queued in the store
  /// and the process should exit without waiting for it.
  bool wait_stopped(std::chrono::milliseconds patience);

 private:
  struct Active {
    std::atomic<bool> cancel{false};
  };
  void recover();
  void work();
  bool take_next(StoredRun& run, std::shared_ptr<Active>& active);
  void execute_one(const StoredRun& run, const std::atomic<bool>& cancel);

  Store& store_;
  const StateFolder& folder_;
  ChangeBell& bell_;
  Metrics& metrics_;
  const Settings& settings_;
  std::mutex mutex_;  ///< guards active_, running_workers_ and the order of claim and cancel
  std::condition_variable wake_, stopped_;
  std::map<std::string, std::shared_ptr<Active>> active_;
  int running_workers_ = 0;
  std::atomic<bool> stopping_{false};
  std::vector<std::thread> workers_;
};

}  // namespace quicksand
