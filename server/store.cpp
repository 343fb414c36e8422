#include "server/store.hpp"

#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>

#include "server/random_text.hpp"
#include "server/sha256.hpp"
#include "server/store_rows.hpp"
#include "server/store_schema.hpp"

namespace quicksand {
namespace {

constexpr int busy_timeout_ms = 5000;

/// 64 random bits: not to be guessed, no meaning.
std::string new_id() { return random_hex(8); }

/// What became of an earlier request with the same idempotency key; empty when there was none.
std::optional<CreateOutcome> find_repeated(SQLite::Database& database, const NewRun& run,
                                           const std::string& request_sha256) {
  if (run.idempotency_key.empty()) return {};
  SQLite::Statement key(database,
                        "SELECT request_sha256, run_id FROM idempotency_keys WHERE owner = ? AND key = ?");
  key.bind(1, run.owner);
  key.bind(2, run.idempotency_key);
  if (!key.executeStep()) return {};
  if (key.getColumn(0).getString() != request_sha256) return CreateOutcome{CreateOutcome::Kind::conflict, {}};
  return CreateOutcome{CreateOutcome::Kind::repeated, find_run(database, key.getColumn(1).getString())};
}

int64_t count_active(SQLite::Database& database, const std::string& owner) {
  SQLite::Statement rows(database,
                         "SELECT COUNT(*) FROM runs WHERE owner = ? AND state IN "
                         "('queued', 'running', 'canceling')");
  rows.bind(1, owner);
  rows.executeStep();
  return rows.getColumn(0).getInt64();
}

void insert_run(SQLite::Database& database, const std::string& id, const NewRun& run,
                const std::string& case_sha256, int64_t now) {
  SQLite::Statement insert(
      database,
      "INSERT INTO runs (id, state, name, label, case_text, case_sha256, engine_version, created, owner, "
      "priority, points, memory_bytes, estimated_s, kind, budget_s) "
      "VALUES (?, 'queued', ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind(1, id);
  insert.bind(2, run.name);
  insert.bind(3, run.label);
  insert.bind(4, run.case_text);
  insert.bind(5, case_sha256);
  insert.bind(6, run.engine_version);
  insert.bind(7, now);
  insert.bind(8, run.owner);
  insert.bind(9, run.priority);
  insert.bind(10, run.cost.points);
  insert.bind(11, run.cost.memory_bytes);
  insert.bind(12, run.cost.seconds);
  insert.bind(13, kind_name(run.kind));
  insert.bind(14, run.budget);
  insert.exec();
}

}  // namespace

Store::Store(const std::filesystem::path& file, Clock clock)
    : state_(file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, busy_timeout_ms),
      progress_(file.string(), SQLite::OPEN_READWRITE, busy_timeout_ms),
      reads_(file.string(), SQLite::OPEN_READWRITE, busy_timeout_ms),
      clock_(std::move(clock)) {
  state_.exec("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
  apply_store_schema(state_);
  progress_.exec("PRAGMA synchronous = NORMAL;");
}

CreateOutcome Store::create(const NewRun& run, const QueueLimits& limits) {
  const std::string case_sha256 = sha256_text(run.case_text);
  const std::string request_sha256 =
      sha256_text(case_sha256 + run.label + (run.priority != 0 ? std::to_string(run.priority) : "") +
                  (run.kind == RunKind::run ? "" : kind_name(run.kind) + std::to_string(run.budget)));
  const std::lock_guard lock(mutex_);
  const int64_t now = clock_();
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  SQLite::Statement expire(state_, "DELETE FROM idempotency_keys WHERE created <= ?");
  expire.bind(1, static_cast<int64_t>(now - idempotency_lifetime));
  expire.exec();
  if (auto earlier = find_repeated(state_, run, request_sha256)) return *earlier;
  if (count_in(state_, RunState::queued) >= limits.queued) return {CreateOutcome::Kind::full, {}};
  if (count_active(state_, run.owner) >= limits.per_owner) return {CreateOutcome::Kind::over_quota, {}};
  const std::string id = new_id();
  insert_run(state_, id, run, case_sha256, now);
  if (!run.idempotency_key.empty()) {
    SQLite::Statement key(state_, "INSERT INTO idempotency_keys VALUES (?, ?, ?, ?, ?)");
    key.bind(1, run.owner);
    key.bind(2, run.idempotency_key);
    key.bind(3, request_sha256);
    key.bind(4, id);
    key.bind(5, now);
    key.exec();
  }
  transaction.commit();
  return {CreateOutcome::Kind::created, find_run(state_, id)};
}

std::optional<StoredRun> Store::find(const std::string& id) {
  const std::lock_guard lock(read_mutex_);
  return find_run(reads_, id);
}

std::optional<std::string> Store::case_text(const std::string& id) {
  const std::lock_guard lock(read_mutex_);
  SQLite::Statement row(reads_, "SELECT case_text FROM runs WHERE id = ?");
  row.bind(1, id);
  if (!row.executeStep()) return {};
  return row.getColumn(0).getString();
}

std::vector<StoredRun> Store::list(const RunFilter& filter) {
  const std::lock_guard lock(read_mutex_);
  SQLite::Statement rows(reads_, std::string("SELECT ") + run_columns +
                                     " FROM runs WHERE (?1 IS NULL OR state = ?1)"
                                     " AND (?2 IS NULL OR label = ?2)"
                                     " AND (?3 IS NULL OR substr(name, 1, length(?3)) = ?3)"
                                     " AND (?4 IS NULL OR created > ?4)"
                                     " AND (?5 IS NULL OR sequence < ?5)"
                                     " AND (?7 IS NULL OR owner = ?7)"
                                     " ORDER BY sequence DESC LIMIT ?6");
  if (filter.state) rows.bind(1, state_name(*filter.state));
  if (filter.label) rows.bind(2, *filter.label);
  if (filter.name_prefix) rows.bind(3, *filter.name_prefix);
  if (filter.created_after) rows.bind(4, static_cast<int64_t>(*filter.created_after));
  if (filter.before_sequence) rows.bind(5, static_cast<int64_t>(*filter.before_sequence));
  rows.bind(6, filter.limit);
  if (filter.owner) rows.bind(7, *filter.owner);
  std::vector<StoredRun> runs;
  while (rows.executeStep()) runs.push_back(read_run(rows));
  return runs;
}

int Store::count(RunState state) {
  const std::lock_guard lock(read_mutex_);
  return count_in(reads_, state);
}

Store::Removal Store::remove(const std::string& id) {
  const std::lock_guard lock(mutex_);
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  const auto run = find_run(state_, id);
  if (!run) return Removal::unknown;
  if (is_active(run->state)) return Removal::active;
  SQLite::Statement remove(state_, "DELETE FROM runs WHERE id = ?");
  remove.bind(1, id);
  remove.exec();
  transaction.commit();
  return Removal::removed;
}

std::vector<StoredResult> Store::results(const std::string& id) {
  const std::lock_guard lock(read_mutex_);
  SQLite::Statement rows(reads_, "SELECT name, bytes, sha256 FROM results WHERE run_id = ? ORDER BY name");
  rows.bind(1, id);
  std::vector<StoredResult> results;
  while (rows.executeStep())
    results.push_back({rows.getColumn(0).getString(),
                       static_cast<std::uintmax_t>(rows.getColumn(1).getInt64()),
                       rows.getColumn(2).getString()});
  return results;
}

void Store::check_writable() {
  const std::lock_guard lock(progress_mutex_);
  SQLite::Transaction transaction(progress_, SQLite::TransactionBehavior::IMMEDIATE);
  const int version = progress_.execAndGet("PRAGMA user_version").getInt();
  progress_.exec("PRAGMA user_version = " + std::to_string(version));  // writes a page, the same as before
  transaction.commit();
}

}  // namespace quicksand
