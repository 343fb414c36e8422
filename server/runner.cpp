#include "server/runner.hpp"

#include <spdlog/spdlog.h>

#include <array>

#include "server/execute.hpp"
#include "server/run_monitor.hpp"
#include "server/sha256.hpp"

namespace quicksand {
namespace {

/// The files of a complete run; `.part` beside them is what a killed server left.
constexpr std::array<const char*, 3> result_names{"result.vtkhdf", "result.xdmf", "run.json"};

/// Before a worker tries again after the store refused.
constexpr std::chrono::seconds store_retry{1};

void remove_results(const std::filesystem::path& folder) {
  for (const char* name : result_names) {
    std::filesystem::remove(folder / name);
    std::filesystem::remove(folder / (std::string(name) + ".part"));
  }
}

std::vector<StoredResult> collect_results(const std::filesystem::path& folder) {
  std::vector<StoredResult> results;
  for (const char* name : result_names) {
    const auto file = folder / name;
    if (std::filesystem::is_regular_file(file))
      results.push_back({name, std::filesystem::file_size(file), sha256_file(file)});
  }
  return results;
}

std::string one_line(const std::vector<Fault>& faults) {
  std::string text;
  for (const Fault& fault : faults) text += (text.empty() ? "" : "; ") + fault.pointer + ": " + fault.detail;
  return text;
}

RunState end_state(RunStatus status) {
  switch (status) {
    case RunStatus::succeeded:
      return RunState::succeeded;
    case RunStatus::canceled:
      return RunState::canceled;
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
  for (int i = 0; i < running_workers_; ++i) workers_.emplace_back([this] { work(); });
}

void Runner::recover() {
  const Recovery recovery = store_.recover();
  for (const auto& id : recovery.requeued)
    spdlog::warn("run={} interrupted, queued again from its start", id);
  for (const auto& id : recovery.interrupted) spdlog::error("run={} interrupted twice, failed", id);
  for (const auto& id : recovery.canceled) spdlog::info("run={} canceled", id);
  // Folders whose record is gone: the server died between deleting the record and its files.
  for (const auto& entry : std::filesystem::directory_iterator(folder_.runs()))
    if (!store_.find(entry.path().filename().string())) std::filesystem::remove_all(entry.path());
}

void Runner::wake() {
  const std::lock_guard lock(mutex_);
  wake_.notify_one();
}

std::optional<StoredRun> Runner::cancel(const std::string& id) {
  std::optional<StoredRun> run;
  {
    const std::lock_guard lock(mutex_);
    run = store_.request_cancel(id);
    const auto active = active_.find(id);
    if (active != active_.end()) active->second->cancel = true;
  }
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

bool Runner::take_next(StoredRun& run, std::shared_ptr<Active>& active) {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    try {
      if (auto next = store_.claim_next()) {
        run = std::move(*next);
        active = std::make_shared<Active>();
        active_[run.id] = active;
        return true;
      }
      wake_.wait(lock);
    } catch (const std::exception& error) {
      spdlog::error("the queue cannot be read: {}", error.what());
      wake_.wait_for(lock, store_retry);
    }
  }
  return false;
}

void Runner::work() {
  StoredRun run;
  std::shared_ptr<Active> active;
  while (take_next(run, active)) {
    bell_.ring();
    try {
      execute_one(run, active->cancel);
    } catch (const std::exception& error) {
      spdlog::error("run={} its end could not be recorded: {}", run.id, error.what());
    }
    {
      const std::lock_guard lock(mutex_);
      active_.erase(run.id);
    }
    bell_.ring();
  }
  const std::lock_guard lock(mutex_);
  --running_workers_;
  stopped_.notify_all();
}

void Runner::execute_one(const StoredRun& run, const std::atomic<bool>& cancel) {
  spdlog::info("run={} started name=\"{}\"", run.id, run.name);
  const auto folder = folder_.run(run.id);
  std::optional<Failure> failure;
  RunState end = RunState::failed;
  std::vector<StoredResult> results;
  try {
    std::filesystem::create_directories(folder);
    remove_results(folder);
    StoreMonitor monitor(run, store_, folder_, bell_, metrics_, cancel, stopping_);
    monitor.log("started, engine " + run.engine_version);
    RunOptions options;
    options.threads = static_cast<int>(settings_.threads_per_run);
    const Execution done =
        execute(store_.case_text(run.id).value_or(""), {}, folder.string(), monitor, options);
    monitor.flush();
    end = done.faults.empty() ? end_state(done.report.status) : RunState::failed;
    if (!done.faults.empty()) failure = Failure{"invalid_case", one_line(done.faults), 0, {}};
    if (done.faults.empty() && end == RunState::failed) failure = done.report.failure;
    if (end == RunState::canceled && stopping_ && !cancel) {
      monitor.log("the server stops; the run is queued again");
      spdlog::info("run={} queued again, the server stops", run.id);
      return store_.requeue(run.id);
    }
    monitor.log(std::string("ended: ") + state_name(end) + (failure ? " " + failure->message : ""));
    results = collect_results(folder);
  } catch (const std::exception& error) {
    end = RunState::failed;
    failure = Failure{"output", error.what(), 0, {}};
  }
  store_.finish(run.id, end, failure, results);
  spdlog::info("run={} ended status={}{}", run.id, state_name(end), failure ? " code=" + failure->code : "");
}

}  // namespace quicksand
