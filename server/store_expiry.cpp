// Results that are removed by policy: their record stays and says so.

#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>

#include "server/store.hpp"

namespace quicksand {

double Store::results_bytes() {
  const std::lock_guard lock(read_mutex_);
  return reads_.execAndGet("SELECT TOTAL(bytes) FROM results").getDouble();
}

std::vector<std::string> Store::expire(Milliseconds time) {
  const std::lock_guard lock(mutex_);
  SQLite::Transaction transaction(state_, SQLite::TransactionBehavior::IMMEDIATE);
  SQLite::Statement old(state_,
                        "SELECT id FROM runs WHERE finished < ? AND expired IS NULL AND state IN "
                        "('succeeded', 'failed', 'canceled')");
  old.bind(1, static_cast<int64_t>(time));
  std::vector<std::string> ids;
  while (old.executeStep()) ids.push_back(old.getColumn(0).getString());
  for (const std::string& id : ids) {
    SQLite::Statement forget(state_, "DELETE FROM results WHERE run_id = ?");
    forget.bind(1, id);
    forget.exec();
    SQLite::Statement mark(state_, "UPDATE runs SET expired = ?, revision = revision + 1 WHERE id = ?");
    mark.bind(1, static_cast<int64_t>(clock_()));
    mark.bind(2, id);
    mark.exec();
  }
  transaction.commit();
  return ids;
}

std::vector<std::string> Store::expired() {
  const std::lock_guard lock(read_mutex_);
  SQLite::Statement rows(reads_, "SELECT id FROM runs WHERE expired IS NOT NULL");
  std::vector<std::string> ids;
  while (rows.executeStep()) ids.push_back(rows.getColumn(0).getString());
  return ids;
}

}  // namespace quicksand
