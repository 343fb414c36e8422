#pragma once
#include <spdlog/logger.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>

#include "engine/run/run.hpp"
#include "server/change_bell.hpp"
#include "server/metrics.hpp"
#include "server/state_folder.hpp"
#include "server/store.hpp"

namespace quicksand {

/// `<runs>/<id>/run.log`: what happened in a run, every line with the run's id.
std::filesystem::path run_log_file(const StateFolder& folder, const std::string& id);

/// What others ask of a run and what they watch of it.
struct RunSignals {
  const std::atomic<bool>& cancel;    ///< ends it within one step
  const std::atomic<bool>& suspend;   ///< ends it so that it can go on from there
  const std::atomic<bool>& stopping;  ///< likewise
  std::atomic<double>& computed_s;    ///< wall time, before interruptions included
};

/// Carries a run's progress into the store, its words into its log and cancellation into the run.
class StoreMonitor final : public RunMonitor {
 public:
  /// Progress is written at most this often, whatever the length of a step.
  static constexpr std::chrono::milliseconds progress_interval{500};

  /// Opens the log; throws spdlog::spdlog_ex when the disk refuses.
  StoreMonitor(const StoredRun& run, Store& store, const StateFolder& folder, ChangeBell& bell,
               Metrics& metrics, const RunSignals& signals);

  void progress(const Progress& now) override;
  void log(const std::string& line) override;
  bool cancelled() override { return signals_.cancel; }
  bool suspended() override { return signals_.suspend || signals_.stopping; }
  /// The run has left so many frames: writes the last progress, which the throttle may have held back and
  /// which does not know yet of frames that were still on their way to the file.
  void finish(std::size_t frames);

 private:
  void store_progress();

  std::string id_;
  Store& store_;
  ChangeBell& bell_;
  Metrics& metrics_;
  RunSignals signals_;
  std::shared_ptr<spdlog::logger> log_;
  Progress last_;
  bool unwritten_ = false;
  std::chrono::steady_clock::time_point next_write_{};
};

}  // namespace quicksand
