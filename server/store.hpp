#pragma once
// What the server knows about its runs, in one SQLite file. Survives kill −9 at any moment: every change of
// state is one transaction with synchronous=FULL. Progress alone is written with synchronous=NORMAL.

#include <SQLiteCpp/Database.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/run/run.hpp"
#include "server/clock.hpp"

namespace quicksand {

enum class RunState { queued, running, canceling, succeeded, failed, canceled };
const char* state_name(RunState state);
std::optional<RunState> state_from_name(const std::string& name);
inline constexpr std::array all_run_states{RunState::queued,    RunState::running, RunState::canceling,
                                           RunState::succeeded, RunState::failed,  RunState::canceled};
/// queued, running or canceling: the run's files may still change.
bool is_active(RunState state);

/// A case computed, or the ladder of its settings measured.
enum class RunKind { run, tradeoff };
const char* kind_name(RunKind kind);

/// What the plan says a run will take.
struct RunCost {
  std::int64_t points = 0;  ///< 0: not planned yet
  double memory_bytes = 0;
  double seconds = 0;  ///< wall time
};

struct StoredRun {
  long long sequence = 0;  ///< rises with creation
  std::string id;
  RunState state = RunState::queued;
  std::string name, label;
  std::string owner;  ///< name of the API key that submitted it; empty without keys
  int priority = 0;   ///< higher ones first
  RunKind kind = RunKind::run;
  double budget = 0;  ///< s of CPU time, of a tradeoff
  RunCost cost;
  std::string case_sha256, engine_version;
  Milliseconds created = 0;
  std::optional<Milliseconds> started, finished;
  std::optional<Failure> failure;       ///< of a failed run; of a queued one, why it stopped and waits
  std::string progress;                 ///< JSON text; empty until the first step
  int retries = 0;                      ///< interruptions in a row, without a checkpoint between them
  long long revision = 0;               ///< rises with every change of this record
  std::optional<Milliseconds> expired;  ///< when its files were removed by policy
};

struct StoredResult {
  std::string name;
  std::uintmax_t bytes = 0;
  std::string sha256;
};

struct NewRun {
  std::string case_text, name, label, engine_version;
  std::string idempotency_key;  ///< empty: none
  std::string owner;
  int priority = 0;
  RunCost cost;
  RunKind kind = RunKind::run;
  double budget = 0;  ///< s of CPU time, of a tradeoff
};

struct QueueLimits {
  std::int64_t queued = 0;     ///< runs waiting, of all owners
  std::int64_t per_owner = 0;  ///< runs waiting or computing
};

struct CreateOutcome {
  enum class Kind {
    created,
    repeated,    ///< same key and body: `run` is the earlier one
    conflict,    ///< same key, other body or label
    full,        ///< too many queued runs
    over_quota,  ///< too many of this owner
  } kind;
  std::optional<StoredRun> run;
};

struct ClaimRules {
  double free_memory = std::numeric_limits<double>::infinity();  ///< bytes; who does not fit makes all wait
  double longest_s = std::numeric_limits<double>::infinity();    ///< only runs estimated at no more
};

struct RunFilter {
  std::optional<RunState> state;
  std::optional<std::string> label, name_prefix, owner;
  std::optional<Milliseconds> created_after;
  std::optional<long long> before_sequence;  ///< page: only older runs than this one
  int limit = 50;
};

struct Recovery {
  std::vector<std::string> requeued, interrupted, canceled;  ///< ids
};

/// Thread-safe. Members throw SQLite::Exception when the disk refuses.
class Store {
 public:
  /// An idempotency key is remembered this long.
  static constexpr Milliseconds idempotency_lifetime = 24LL * 3600 * 1000;

  /// Opens or creates the file. Throws std::runtime_error when it was written by a newer version.
  explicit Store(const std::filesystem::path& file, Clock clock = utc_now);

  CreateOutcome create(const NewRun& run, const QueueLimits& limits);
  std::optional<StoredRun> find(const std::string& id);
  std::optional<std::string> case_text(const std::string& id);
  /// Newest first.
  std::vector<StoredRun> list(const RunFilter& filter);
  int count(RunState state);

  /// The queued run whose turn it is, now running; empty when there is none. Higher priorities first, among
  /// equals the owner who has waited longest since a run of his began, then the oldest.
  std::optional<StoredRun> claim_next(const ClaimRules& rules = {});
  /// queued → canceled, running → canceling; others stay. Empty when there is no such run.
  std::optional<StoredRun> request_cancel(const std::string& id);
  void set_progress(const std::string& id, const std::string& json);
  /// The run has ended; `results` are complete and will not change.
  void finish(const std::string& id, RunState end, const std::optional<Failure>& failure,
              const std::vector<StoredResult>& results);
  /// running → queued: it goes on later. `failure`: what it waits for; forgotten when it is claimed.
  void requeue(const std::string& id, const std::optional<Failure>& failure = {});
  /// Of a run that has ended.
  void add_results(const std::string& id, const std::vector<StoredResult>& results);
  /// To be called once at start: what a killed server left running is queued again, but fails with code
  /// "interrupted" when that happens `most_fruitless` times in a row without `advanced(run)`: it may be what
  /// brings the server down. What was being canceled is canceled.
  static constexpr int most_fruitless = 8;
  Recovery recover(const std::function<bool(const StoredRun&)>& advanced);

  enum class Removal { removed, active, unknown };
  Removal remove(const std::string& id);
  std::vector<StoredResult> results(const std::string& id);

  /// Oldest first.
  std::vector<StoredRun> queued();
  void set_cost(const std::string& id, const RunCost& cost);
  /// Bytes of the results of all ended runs.
  double results_bytes();
  /// Marks the runs that ended before `time` as expired and forgets their results; their ids.
  std::vector<std::string> expire(Milliseconds time);
  std::vector<std::string> expired();
  /// Throws when nothing can be written.
  void check_writable();

 private:
  std::mutex mutex_;           ///< guards state_
  SQLite::Database state_;     ///< synchronous=FULL
  std::mutex progress_mutex_;  ///< guards progress_
  SQLite::Database progress_;  ///< synchronous=NORMAL
  std::mutex read_mutex_;      ///< guards reads_
  SQLite::Database reads_;     ///< never waits for the disk
  Clock clock_;
};

}  // namespace quicksand
