#include "server/store.hpp"

#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>
#include <sys/random.h>

#include <array>
#include <stdexcept>

#include "server/sha256.hpp"
#include "server/store_rows.hpp"
#include "server/store_schema.hpp"

namespace quicksand {
namespace {

constexpr int busy_timeout_ms = 5000;

/// 64 random bits in hexadecimal: not to be guessed, no meaning.
std::string new_id() {
  std::array<unsigned char, 8> bits{};
  if (getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size()))
    throw std::runtime_error("no random numbers");
  static constexpr char digits[] = "0123456789abcdef";
  std::string id;
  for (const unsigned char b : bits) {
    id += digits[b >> 4];
    id += digits[b & 15];
  }
  return id;
}

void set_failure(SQLite::Database& database, const std::string& id, const Failure& failure) {
  SQLite::Statement set(database,
                        "UPDATE runs SET failure_code = ?, failure_message = ?, failure_time = ?, "
                        "failure_x = ?, failure_y = ?, failure_z = ? WHERE id = ?");
  set.bind(1, failure.code);
  set.bind(2, failure.message);
  set.bind(3, failure.time);
  for (int i = 0; i < 3; ++i) set.bind(4 + i, failure.place[i]);
  set.bind(7, id);
  set.exec();
}

/// Moves a run to an end state and stamps it.
void set_ended(SQLite::Database& database, const std::string& id, RunState end, Milliseconds now) {
  SQLite::Statement set(database,
                        "UPDATE runs SET state = ?, finished = ?, revision = revision + 1 WHERE id = ?");
  set.bind(1, state_name(end));
  set.bind(2, static_cast<int64_t>(now));
  set.bind(3, id);
  set.exec();
}

void set_queued_again(SQLite::Database& database, const std::string& id, int more_retries) {
  SQLite::Statement set(database,
                        "UPDATE runs SET state = 'queued', started = NULL, progress = '', retries = retries "
                        "+ ?, revision = revision + 1 WHERE id = ?");
  set.bind(1, more_retries);
  set.bind(2, id);
  set.exec();
}

}  // namespace

Store::Store(const std::filesystem::path& file, Clock clock)
    : state_(file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, busy_timeout_ms),
      progress_(file.string(), SQLite::OPEN_READWRITE, busy_timeout_ms),
      clock_(std::move(clock)) {
  state_.exec("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
  apply_store_schema(state_);
  progress_.exec("PRAGMA synchronous = NORMAL;");
}

CreateOutcome Store::create(const NewRun& run, int max_queued) {
  const std::string case_sha256 = sha256_text(run.case_text);
  const std::string request_sha256 = sha256_text(case_sha256 + run.label);
  const std::lock_guard lock(mutex_);
  const int64_t now = clock_();
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  SQLite::Statement expire(state_, "DELETE FROM idempotency_keys WHERE created <= ?");
  expire.bind(1, static_cast<int64_t>(now - idempotency_lifetime));
  expire.exec();
  if (!run.idempotency_key.empty()) {
    SQLite::Statement key(state_, "SELECT request_sha256, run_id FROM idempotency_keys WHERE key = ?");
    key.bind(1, run.idempotency_key);
    if (key.executeStep()) {
      if (key.getColumn(0).getString() != request_sha256) return {CreateOutcome::Kind::conflict, {}};
      return {CreateOutcome::Kind::repeated, find_run(state_, key.getColumn(1).getString())};
    }
  }
  if (count_in(state_, RunState::queued) >= max_queued) return {CreateOutcome::Kind::full, {}};

  const std::string id = new_id();
  SQLite::Statement insert(
      state_,
      "INSERT INTO runs (id, state, name, label, case_text, case_sha256, engine_version, "
      "created) VALUES (?, 'queued', ?, ?, ?, ?, ?, ?)");
  insert.bind(1, id);
  insert.bind(2, run.name);
  insert.bind(3, run.label);
  insert.bind(4, run.case_text);
  insert.bind(5, case_sha256);
  insert.bind(6, run.engine_version);
  insert.bind(7, now);
  insert.exec();
  if (!run.idempotency_key.empty()) {
    SQLite::Statement key(state_, "INSERT INTO idempotency_keys VALUES (?, ?, ?, ?)");
    key.bind(1, run.idempotency_key);
    key.bind(2, request_sha256);
    key.bind(3, id);
    key.bind(4, now);
    key.exec();
  }
  transaction.commit();
  return {CreateOutcome::Kind::created, find_run(state_, id)};
}

std::optional<StoredRun> Store::find(const std::string& id) {
  const std::lock_guard lock(mutex_);
  return find_run(state_, id);
}

std::optional<std::string> Store::case_text(const std::string& id) {
  const std::lock_guard lock(mutex_);
  SQLite::Statement row(state_, "SELECT case_text FROM runs WHERE id = ?");
  row.bind(1, id);
  if (!row.executeStep()) return {};
  return row.getColumn(0).getString();
}

std::vector<StoredRun> Store::list(const RunFilter& filter) {
  const std::lock_guard lock(mutex_);
  SQLite::Statement rows(state_, std::string("SELECT ") + run_columns +
                                     " FROM runs WHERE (?1 IS NULL OR state = ?1)"
                                     " AND (?2 IS NULL OR label = ?2)"
                                     " AND (?3 IS NULL OR substr(name, 1, length(?3)) = ?3)"
                                     " AND (?4 IS NULL OR created > ?4)"
                                     " AND (?5 IS NULL OR sequence < ?5)"
                                     " ORDER BY sequence DESC LIMIT ?6");
  if (filter.state) rows.bind(1, state_name(*filter.state));
  if (filter.label) rows.bind(2, *filter.label);
  if (filter.name_prefix) rows.bind(3, *filter.name_prefix);
  if (filter.created_after) rows.bind(4, static_cast<int64_t>(*filter.created_after));
  if (filter.before_sequence) rows.bind(5, static_cast<int64_t>(*filter.before_sequence));
  rows.bind(6, filter.limit);
  std::vector<StoredRun> runs;
  while (rows.executeStep()) runs.push_back(read_run(rows));
  return runs;
}

int Store::count(RunState state) {
  const std::lock_guard lock(mutex_);
  return count_in(state_, state);
}

std::optional<StoredRun> Store::claim_next() {
  const std::lock_guard lock(mutex_);
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  SQLite::Statement next(state_, "SELECT id FROM runs WHERE state = 'queued' ORDER BY sequence LIMIT 1");
  if (!next.executeStep()) return {};
  const std::string id = next.getColumn(0).getString();
  SQLite::Statement set(
      state_, "UPDATE runs SET state = 'running', started = ?, revision = revision + 1 WHERE id = ?");
  set.bind(1, static_cast<int64_t>(clock_()));
  set.bind(2, id);
  set.exec();
  next.reset();
  transaction.commit();
  return find_run(state_, id);
}

std::optional<StoredRun> Store::request_cancel(const std::string& id) {
  const std::lock_guard lock(mutex_);
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  const auto run = find_run(state_, id);
  if (!run) return {};
  if (run->state == RunState::queued) set_ended(state_, id, RunState::canceled, clock_());
  if (run->state == RunState::running) {
    SQLite::Statement set(state_,
                          "UPDATE runs SET state = 'canceling', revision = revision + 1 WHERE id = ?");
    set.bind(1, id);
    set.exec();
  }
  transaction.commit();
  return find_run(state_, id);
}

void Store::set_progress(const std::string& id, const std::string& json) {
  const std::lock_guard lock(progress_mutex_);
  SQLite::Statement set(progress_,
                        "UPDATE runs SET progress = ?, revision = revision + 1 WHERE id = ? AND state IN "
                        "('running', 'canceling')");
  set.bind(1, json);
  set.bind(2, id);
  set.exec();
}

void Store::finish(const std::string& id, RunState end, const std::optional<Failure>& failure,
                   const std::vector<StoredResult>& results) {
  const std::lock_guard lock(mutex_);
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  set_ended(state_, id, end, clock_());
  if (failure) set_failure(state_, id, *failure);
  for (const StoredResult& result : results) {
    SQLite::Statement insert(state_, "INSERT OR REPLACE INTO results VALUES (?, ?, ?, ?)");
    insert.bind(1, id);
    insert.bind(2, result.name);
    insert.bind(3, static_cast<int64_t>(result.bytes));
    insert.bind(4, result.sha256);
    insert.exec();
  }
  transaction.commit();
}

void Store::requeue(const std::string& id) {
  const std::lock_guard lock(mutex_);
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  const auto run = find_run(state_, id);
  if (run && run->state == RunState::running) set_queued_again(state_, id, 0);
  transaction.commit();
}

Recovery Store::recover() {
  const std::lock_guard lock(mutex_);
  Recovery recovery;
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  for (const StoredRun& run : runs_in(state_, RunState::canceling)) {
    set_ended(state_, run.id, RunState::canceled, clock_());
    recovery.canceled.push_back(run.id);
  }
  for (const StoredRun& run : runs_in(state_, RunState::running)) {
    if (run.retries == 0) {
      set_queued_again(state_, run.id, 1);
      recovery.requeued.push_back(run.id);
      continue;
    }
    set_failure(state_, run.id,
                {"interrupted",
                 "the server was killed twice while it computed this run; it is not tried a third time",
                 0,
                 {}});
    set_ended(state_, run.id, RunState::failed, clock_());
    recovery.interrupted.push_back(run.id);
  }
  transaction.commit();
  return recovery;
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
  const std::lock_guard lock(mutex_);
  SQLite::Statement rows(state_, "SELECT name, bytes, sha256 FROM results WHERE run_id = ? ORDER BY name");
  rows.bind(1, id);
  std::vector<StoredResult> results;
  while (rows.executeStep())
    results.push_back({rows.getColumn(0).getString(),
                       static_cast<std::uintmax_t>(rows.getColumn(1).getInt64()),
                       rows.getColumn(2).getString()});
  return results;
}

void Store::check_writable() {
  const std::lock_guard lock(mutex_);
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  state_.exec("UPDATE runs SET state = state WHERE sequence = 0");
}

}  // namespace quicksand
