// What happens beside the workers: order after a kill, limits of what computes, results that have their time.

#include <spdlog/spdlog.h>

#include "api/case_json.hpp"
#include "engine/results/checkpoint_file.hpp"
#include "server/calibration_file.hpp"
#include "server/limits.hpp"
#include "server/machine.hpp"
#include "server/run_files.hpp"
#include "server/runner.hpp"

namespace quicksand {
namespace {

double seconds(std::chrono::steady_clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

/// Between two looks at what the runs take.
constexpr std::chrono::seconds guard_interval{1};
constexpr Milliseconds day_ms = 24LL * 3600 * 1000;

/// When it was stored; 0: there is none.
Milliseconds newest_checkpoint(const std::filesystem::path& run_folder) {
  const auto files = checkpoint_files(run_folder);
  std::error_code none;
  if (files.empty()) return 0;
  const auto written = std::filesystem::last_write_time(files.front(), none);
  const auto since_epoch = std::chrono::file_clock::to_sys(written).time_since_epoch();
  return none ? 0 : std::chrono::duration_cast<std::chrono::milliseconds>(since_epoch).count();
}

}  // namespace

void Runner::recover() {
  const Recovery recovery = store_.recover([&](const StoredRun& run) {
    return run.started && newest_checkpoint(folder_.run(run.id)) > *run.started;
  });
  for (const auto& id : recovery.requeued)
    spdlog::warn("run={} interrupted, queued again{}", id,
                 newest_checkpoint(folder_.run(id)) > 0 ? " from its last checkpoint" : " from its start");
  for (const auto& id : recovery.interrupted)
    spdlog::error("run={} interrupted too often without getting further, failed", id);
  for (const auto& id : recovery.canceled) spdlog::info("run={} canceled", id);
  left_over_.insert(recovery.canceled.begin(), recovery.canceled.end());
  left_over_.insert(recovery.interrupted.begin(), recovery.interrupted.end());
  for (const StoredRun& run : store_.queued())
    if (std::filesystem::exists(folder_.run(run.id))) begun_.insert(run.id);
  // Folders whose record is gone: the server died between deleting the record and its files.
  for (const auto& entry : std::filesystem::directory_iterator(folder_.runs()))
    if (!store_.find(entry.path().filename().string())) std::filesystem::remove_all(entry.path());
  for (const auto& id : store_.expired()) remove_results(folder_.run(id));  // or expiring them
  plan_what_waits();
}

/// Runs of an earlier version have no plan yet, and limits may have become smaller since they were submitted.
void Runner::plan_what_waits() {
  for (StoredRun& run : store_.queued()) {
    if (run.cost.points == 0) {
      const ParsedCase parsed = parse_case(store_.case_text(run.id).value_or(""), {},
                                           read_calibration(state_calibration(folder_.path())));
      if (parsed.scene) run.cost = cost_of(make_plan(*parsed.scene));
      store_.set_cost(run.id, run.cost);
    }
    if (const auto faults = too_large(settings_, run.cost); !faults.empty()) {
      store_.finish(run.id, RunState::failed, Failure{"too_large", faults.front().detail, 0, {}}, {});
      spdlog::warn("run={} failed: {}", run.id, faults.front().detail);
    }
  }
}

void Runner::guard() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    try {
      enforce_limits();
      expire_results();
      keep_what_canceled_runs_left(lock);
    } catch (const std::exception& error) {
      spdlog::error("guard: {}", error.what());
    }
    wake_.wait_for(lock, guard_interval);
  }
}

/// The run ends within one step, failed. mutex_ is held.
void Runner::end_for(Active& active, const Failure& failure) {
  if (active.limit || active.cancel) return;
  spdlog::warn("run={} is ended: {}", active.run.id, failure.message);
  active.limit = failure;
  active.cancel = true;
}

/// mutex_ is held.
void Runner::enforce_limits() {
  if (active_.empty()) return;
  const auto now = std::chrono::steady_clock::now();
  for (const auto& [id, active] : active_)
    if (const auto failure =
            out_of_time(settings_, std::max(seconds(now - active->begin), active->computed_s.load())))
      end_for(*active, *failure);
  suspend_without_room();
  if (const auto failure = out_of_memory(settings_, resident_memory())) {  // the newest made it too much
    const auto newest = std::max_element(active_.begin(), active_.end(), [](const auto& a, const auto& b) {
      return a.second->begin < b.second->begin;
    });
    end_for(*newest->second, *failure);
  }
}

/// The record first: files without a record of their own are removed at the next start.
void Runner::expire_results() {
  if (settings_.keep_days == 0) return;
  for (const std::string& id : store_.expire(utc_now() - settings_.keep_days * day_ms)) {
    remove_results(folder_.run(id));
    spdlog::info("run={} results removed after {} days (keep_days)", id, settings_.keep_days);
    bell_.ring();
  }
}

}  // namespace quicksand
