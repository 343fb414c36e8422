#include "server/run_monitor.hpp"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "server/run_json.hpp"

namespace quicksand {

std::filesystem::path run_log_file(const StateFolder& folder, const std::string& id) {
  return folder.run(id) / "run.log";
}

StoreMonitor::StoreMonitor(const StoredRun& run, Store& store, const StateFolder& folder, ChangeBell& bell,
                           Metrics& metrics, const RunSignals& signals)
    : id_(run.id), store_(store), bell_(bell), metrics_(metrics), signals_(signals) {
  auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(run_log_file(folder, id_).string());
  log_ = std::make_shared<spdlog::logger>(id_, std::move(sink));
  log_->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ run=%n %v", spdlog::pattern_time_type::utc);
  log_->flush_on(spdlog::level::info);
}

void StoreMonitor::progress(const Progress& now) {
  metrics_.stepped(now.step - last_.step);
  last_ = now;
  signals_.computed_s = now.wall_seconds;
  unwritten_ = true;
  const auto time = std::chrono::steady_clock::now();
  if (time < next_write_) return;
  next_write_ = time + progress_interval;
  store_progress();
}

void StoreMonitor::finish(std::size_t frames) {
  const bool began = last_.step > 0;
  if (!began || (!unwritten_ && frames <= last_.frames)) return;
  last_.frames = std::max(last_.frames, frames);
  store_progress();
}

void StoreMonitor::store_progress() {
  try {
    store_.set_progress(id_, progress_json(last_));
    unwritten_ = false;
    bell_.ring();
  } catch (const std::exception& error) {  // a full disk must not end the run by itself
    spdlog::warn("run={} progress not stored: {}", id_, error.what());
  }
}

void StoreMonitor::log(const std::string& line) { log_->info(line); }

}  // namespace quicksand
