#include "server/runner.hpp"

#include <pthread.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>

#include "engine/results/checkpoint_file.hpp"
#include "engine/results/disk_space.hpp"
#include "server/calibration_file.hpp"
#include "server/execute.hpp"
#include "server/limits.hpp"
#include "server/run_files.hpp"
#include "server/run_json.hpp"
#include "server/run_monitor.hpp"
#include "server/tradeoff_run.hpp"

namespace quicksand {
namespace {

/// By which `top` and tests/faults/load.py tell what computes from what serves.
constexpr const char* run_thread_name = "quicksand-run";
/// Before a worker tries again after the store refused.
constexpr std::chrono::seconds store_retry{1};

std::string one_line(const std::vector<Fault>& faults) {
  std::string text;
  for (const Fault& fault : faults) text += (text.empty() ? "" : "; ") + fault.pointer + ": " + fault.detail;
  return text;
}

/// Why a run's files could not be written; `words` are the disk's.
Failure not_written(const std::string& message, const std::string& words) {
  const DiskRefusal refusal = disk_refusal(words);
  const bool full = refusal == DiskRefusal::full, read_only = refusal == DiskRefusal::read_only;
  return {full ? "disk_full" : read_only ? "read_only" : "output", message, 0, {}};
}

/// Passes by itself: the run waits for it.
bool is_lack_of_room(const Failure& failure) {
  return failure.code == "disk_full" || failure.code == "read_only";
}

RunState end_state(RunStatus status) {
  switch (status) {
    case RunStatus::succeeded:
      return RunState::succeeded;
    case RunStatus::canceled:
      return RunState::canceled;
    case RunStatus::suspended:
      return RunState::queued;
    case RunStatus::failed:
      break;
  }
  return RunState::failed;
}

}  // namespace

Runner::Runner(Store& store, const StateFolder& folder, ChangeBell& bell, Metrics& metrics,
               const Settings& settings)
    : store_(store), folder_(folder), bell_(bell), metrics_(metrics), settings_(settings) {}

Runner::~Runner() {
  begin_stop();
  for (std::thread& worker : workers_) worker.join();
}

void Runner::start() {
  recover();
  running_workers_ = static_cast<int>(settings_.workers);
  const int for_short_runs = std::min(static_cast<int>(settings_.short_workers), running_workers_ - 1);
  for (int i = 0; i < running_workers_; ++i)
    workers_.emplace_back([this, only = i < for_short_runs] { work(only); });
  workers_.emplace_back([this] { guard(); });
}

void Runner::wake() {
  const std::lock_guard lock(mutex_);
  wake_.notify_all();  // not every worker takes every run
}

std::optional<StoredRun> Runner::cancel(const std::string& id) {
  std::optional<StoredRun> run;
  {
    const std::lock_guard lock(mutex_);
    run = store_.request_cancel(id);
    const auto active = active_.find(id);
    if (active != active_.end()) active->second->cancel = true;
    if (run && run->state == RunState::canceled && begun_.erase(id) > 0) left_over_.insert(id);
  }
  wake_.notify_all();
  bell_.ring();
  return run;
}

void Runner::begin_stop() {
  const std::lock_guard lock(mutex_);
  stopping_ = true;
  wake_.notify_all();
}

bool Runner::wait_stopped(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  if (stopped_.wait_for(lock, patience, [&] { return running_workers_ == 0; })) return true;
  for (const auto& [id, active] : active_) {
    spdlog::warn("run={} did not end in time, queued again", id);
    store_.requeue(id);
  }
  return false;
}

ClaimRules Runner::claim_rules(bool short_runs_only) const {
  ClaimRules rules;
  rules.free_memory = memory_limit(settings_);
  for (const auto& [id, active] : active_) rules.free_memory -= active->run.cost.memory_bytes;
  if (short_runs_only) rules.longest_s = static_cast<double>(settings_.short_run_s);
  return rules;
}

std::shared_ptr<Runner::Active> Runner::take_next(bool short_runs_only) {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    try {
      if (!has_room()) {
        wake_.wait_for(lock, store_retry);
        continue;
      }
      if (auto next = store_.claim_next(claim_rules(short_runs_only))) {
        auto active = std::make_shared<Active>();
        active->run = std::move(*next);
        active_[active->run.id] = active;
        begun_.erase(active->run.id);
        return active;
      }
      wake_.wait(lock);
    } catch (const std::exception& error) {
      tell_of_room(std::string("the store refuses: ") + error.what());
      wake_.wait_for(lock, store_retry);
    }
  }
  return nullptr;
}

void Runner::work(bool short_runs_only) {
  // Both are inherited by the threads of its runs. In Linux niceness belongs to a thread.
  ::pthread_setname_np(::pthread_self(), run_thread_name);
  [[maybe_unused]] const int niceness = ::nice(static_cast<int>(settings_.niceness));
  while (const auto active = take_next(short_runs_only)) {
    bell_.ring();
    execute_one(*active);
    {
      const std::lock_guard lock(mutex_);
      active_.erase(active->run.id);
    }
    wake_.notify_all();  // there is memory again
    bell_.ring();
  }
  const std::lock_guard lock(mutex_);
  --running_workers_;
  stopped_.notify_all();
}

void Runner::execute_one(Active& active) {
  const StoredRun& run = active.run;
  spdlog::info("run={} started name={}", run.id, quoted(run.name));
  End end;
  try {
    end = compute(active);
  } catch (const std::exception& error) {  // its text holds paths of this machine
    spdlog::error("run={} {}", run.id, error.what());
    end.failure = not_written("cannot write in the run's folder", error.what());
  }
  if (end.failure && is_lack_of_room(*end.failure)) end.state = RunState::queued;
  record(active, end);
}

Runner::End Runner::compute(Active& active) {
  const StoredRun& run = active.run;
  const auto folder = folder_.run(run.id);
  std::filesystem::create_directories(folder);
  StoreMonitor monitor(run, store_, folder_, bell_, metrics_,
                       {active.cancel, active.suspend, stopping_, active.computed_s});
  RunOptions options;
  options.threads = run.kind == RunKind::tradeoff ? 1 : threads_for(settings_, run.cost);
  options.checkpoint_interval = static_cast<double>(settings_.checkpoint_s);
  monitor.log("started, engine " + run.engine_version + ", threads " + std::to_string(options.threads));
  const std::string text = store_.case_text(run.id).value_or("");
  const Calibration machine = read_calibration(state_calibration(folder_.path()));
  const Execution done =
      run.kind == RunKind::tradeoff
          ? execute_tradeoff(text, {}, folder.string(), monitor, {{}, 1, run.budget}, machine)
          : execute(text, {}, folder.string(), monitor, options, Resume::if_possible, machine);
  monitor.finish(done.report.frames);

  End end;
  end.state = done.faults.empty() ? end_state(done.report.status) : RunState::failed;
  if (!done.faults.empty()) end.failure = Failure{"invalid_case", one_line(done.faults), 0, {}};
  const bool failed = done.faults.empty() && done.report.status == RunStatus::failed;
  if (failed) end.failure = done.report.failure;
  if (failed && end.failure->code == "output")
    end.failure = not_written(done.report.failure.message, done.report.failure.message);
  const std::lock_guard lock(mutex_);
  if (active.limit && (end.state == RunState::canceled || end.state == RunState::queued)) {
    if (end.state == RunState::canceled) end.state = RunState::failed;
    end.failure = active.limit;
    end.failure->time = done.report.sim_time;
  }
  if (end.failure && is_lack_of_room(*end.failure))
    monitor.log(end.failure->message + "; the run waits and goes on when this has passed");
  else if (end.state == RunState::queued)
    monitor.log("the server stops; the run is queued again and goes on from here");
  else
    monitor.log(std::string("ended: ") + state_name(end.state) +
                (end.failure ? " " + end.failure->message : ""));
  return end;
}

/// A run that was canceled meanwhile, or has come to a limit, has ended.
void Runner::queue_again(Active& active, const End& end) {
  const std::lock_guard lock(mutex_);
  const std::string& id = active.run.id;
  if (active.cancel) {
    const bool limited = active.limit && !is_lack_of_room(*active.limit);
    store_.finish(id, limited ? RunState::failed : RunState::canceled, limited ? active.limit : std::nullopt,
                  {});
    left_over_.insert(id);
    return;
  }
  store_.requeue(id, end.failure);
  begun_.insert(id);
  if (end.failure) pause_for(*end.failure);
}

/// The end of a run that wanted to write when the disk was full is recorded when there is room.
void Runner::record(Active& active, End end) {
  const std::string& id = active.run.id;
  const auto folder = folder_.run(id);
  for (;;) try {
      if (end.state == RunState::queued) {
        queue_again(active, end);
      } else {
        keep_unfinished_results(folder);
        store_.finish(id, end.state, end.failure, collect_results(folder));
      }
      spdlog::info("run={} ended status={}{}", id, state_name(end.state),
                   end.failure ? " code=" + end.failure->code : "");
      return;
    } catch (const std::exception& error) {
      spdlog::error("run={} its end cannot be recorded yet: {}", id, error.what());
      if (stopping_) return;  // the next start finds it running and takes it up again
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, store_retry, [this] { return stopping_.load(); });
    }
}

}  // namespace quicksand
