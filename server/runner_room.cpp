// Runs and the disk: who finds it full or read-only waits, and goes on by himself when that has passed.

#include <spdlog/spdlog.h>

#include <algorithm>

#include "server/limits.hpp"
#include "server/run_files.hpp"
#include "server/runner.hpp"

namespace quicksand {
namespace {

/// After a run has found no room, the queue waits so long before it tries again; twice as long each time
/// that it is in vain. What is free does not tell whether there is enough.
constexpr std::chrono::seconds first_pause{2}, longest_pause{60};

}  // namespace

std::string Runner::shortage() {
  const std::lock_guard lock(mutex_);
  return shortage_now();
}

/// mutex_ is held.
std::string Runner::shortage_now() {
  double bytes = store_.results_bytes();
  for (const auto& [id, active] : active_) bytes += folder_bytes(folder_.run(id));
  for (const std::string& id : begun_) bytes += folder_bytes(folder_.run(id));
  return disk_shortage(settings_, folder_, bytes);
}

/// Whether the queue may go on. Throws when the store cannot be written. mutex_ is held.
bool Runner::has_room() {
  std::string shortage = shortage_now();
  if (shortage.empty() && std::chrono::steady_clock::now() < try_again_) shortage = lacked_;
  if (shortage.empty() && waits_for_room_) store_.check_writable();
  tell_of_room(shortage);
  return shortage.empty();
}

/// The log tells when it changes. mutex_ is held.
void Runner::tell_of_room(const std::string& shortage) {
  if (shortage.empty() != waits_for_room_) return;
  waits_for_room_ = !shortage.empty();
  spdlog::warn("the queue {}{}", waits_for_room_ ? "waits: " : "goes on", shortage);
}

/// mutex_ is held.
void Runner::suspend_without_room() {
  const std::string shortage = shortage_now();
  if (shortage.empty()) return;
  for (const auto& [id, active] : active_) {
    if (active->limit || active->cancel) continue;
    spdlog::warn("run={} is suspended: {}", id, shortage);
    active->limit = Failure{"disk_full", shortage, 0, {}};
    active->suspend = true;
  }
}

/// mutex_ is held.
void Runner::pause_for(const Failure& failure) {
  lacked_ = failure.message;
  pause_ = std::clamp(2 * pause_, first_pause, longest_pause);
  try_again_ = std::chrono::steady_clock::now() + pause_;
}

/// Runs that were canceled while they waited keep their frames, as others do. Sums of large files take their
/// time: `lock`, of mutex_, is released meanwhile.
void Runner::keep_what_canceled_runs_left(std::unique_lock<std::mutex>& lock) {
  const std::set<std::string> ids = std::move(left_over_);
  left_over_.clear();
  lock.unlock();
  for (const std::string& id : ids) try {
      keep_unfinished_results(folder_.run(id));
      store_.add_results(id, collect_results(folder_.run(id)));
      bell_.ring();
    } catch (const std::exception& error) {
      spdlog::error("run={} its results cannot be listed: {}", id, error.what());
    }
  lock.lock();
}

}  // namespace quicksand
