// The way of a run from queued to its end.

#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>

#include "server/store.hpp"
#include "server/store_rows.hpp"

namespace quicksand {
namespace {

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

/// What a queued run waited for no longer matters.
void clear_failure(SQLite::Database& database, const std::string& id) {
  SQLite::Statement clear(database, "UPDATE runs SET failure_code = NULL WHERE id = ?");
  clear.bind(1, id);
  clear.exec();
}

void insert_results(SQLite::Database& database, const std::string& id,
                    const std::vector<StoredResult>& results) {
  for (const StoredResult& result : results) {
    SQLite::Statement insert(database, "INSERT OR REPLACE INTO results VALUES (?, ?, ?, ?)");
    insert.bind(1, id);
    insert.bind(2, result.name);
    insert.bind(3, static_cast<int64_t>(result.bytes));
    insert.bind(4, result.sha256);
    insert.exec();
  }
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

void set_queued_again(SQLite::Database& database, const std::string& id, int retries) {
  SQLite::Statement set(database,
                        "UPDATE runs SET state = 'queued', started = NULL, progress = '', retries = ?, "
                        "revision = revision + 1 WHERE id = ?");
  set.bind(1, retries);
  set.bind(2, id);
  set.exec();
}

}  // namespace

std::optional<StoredRun> Store::claim_next(const ClaimRules& rules) {
  const std::lock_guard lock(mutex_);
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  SQLite::Statement next(state_,
                         "SELECT id, memory_bytes FROM runs WHERE state = 'queued' AND estimated_s <= ? "
                         "ORDER BY priority DESC, (SELECT MAX(started) FROM runs AS own WHERE own.owner = "
                         "runs.owner), sequence LIMIT 1");
  next.bind(1, rules.longest_s);
  if (!next.executeStep() || next.getColumn(1).getDouble() > rules.free_memory) return {};
  const std::string id = next.getColumn(0).getString();
  SQLite::Statement set(
      state_,
      "UPDATE runs SET state = 'running', started = ?, failure_code = NULL, revision = revision + 1 "
      "WHERE id = ?");
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
  if (run->state == RunState::queued) {
    clear_failure(state_, id);
    set_ended(state_, id, RunState::canceled, clock_());
  }
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
  insert_results(state_, id, results);
  transaction.commit();
}

void Store::add_results(const std::string& id, const std::vector<StoredResult>& results) {
  const std::lock_guard lock(mutex_);
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  const auto run = find_run(state_, id);
  if (!run || is_active(run->state) || run->expired) return;
  insert_results(state_, id, results);
  SQLite::Statement set(state_, "UPDATE runs SET revision = revision + 1 WHERE id = ?");
  set.bind(1, id);
  set.exec();
  transaction.commit();
}

void Store::requeue(const std::string& id, const std::optional<Failure>& failure) {
  const std::lock_guard lock(mutex_);
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  const auto run = find_run(state_, id);
  if (run && run->state == RunState::running) {
    set_queued_again(state_, id, run->retries);
    if (failure) set_failure(state_, id, *failure);
  }
  transaction.commit();
}

Recovery Store::recover(const std::function<bool(const StoredRun&)>& advanced) {
  const std::lock_guard lock(mutex_);
  Recovery recovery;
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  for (const StoredRun& run : runs_in(state_, RunState::canceling)) {
    set_ended(state_, run.id, RunState::canceled, clock_());
    recovery.canceled.push_back(run.id);
  }
  for (const StoredRun& run : runs_in(state_, RunState::running)) {
    const int retries = advanced(run) ? 1 : run.retries + 1;
    if (retries < most_fruitless) {
      set_queued_again(state_, run.id, retries);
      recovery.requeued.push_back(run.id);
      continue;
    }
    set_failure(state_, run.id,
                {"interrupted",
                 "the server was killed " + std::to_string(most_fruitless) +
                     " times in a row while it computed this run, before the run got any further; it is not "
                     "tried again",
                 0,
                 {}});
    set_ended(state_, run.id, RunState::failed, clock_());
    recovery.interrupted.push_back(run.id);
  }
  transaction.commit();
  return recovery;
}

std::vector<StoredRun> Store::queued() {
  const std::lock_guard lock(mutex_);
  return runs_in(state_, RunState::queued);
}

void Store::set_cost(const std::string& id, const RunCost& cost) {
  const std::lock_guard lock(mutex_);
  SQLite::Statement set(state_, "UPDATE runs SET points = ?, memory_bytes = ?, estimated_s = ? WHERE id = ?");
  set.bind(1, cost.points);
  set.bind(2, cost.memory_bytes);
  set.bind(3, cost.seconds);
  set.bind(4, id);
  set.exec();
}

}  // namespace quicksand
