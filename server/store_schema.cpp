#include "server/store_schema.hpp"

#include <SQLiteCpp/Transaction.h>

#include <stdexcept>
#include <string>

namespace quicksand {
namespace {

/// Kept in `PRAGMA user_version`; raise it together with a migration.
constexpr int schema_version = 1;

constexpr const char* schema = R"sql(
CREATE TABLE runs (
  sequence         INTEGER PRIMARY KEY AUTOINCREMENT,
  id               TEXT NOT NULL UNIQUE,
  state            TEXT NOT NULL CHECK (state IN
                     ('queued', 'running', 'canceling', 'succeeded', 'failed', 'canceled')),
  name             TEXT NOT NULL,
  label            TEXT NOT NULL,
  case_text        TEXT NOT NULL,
  case_sha256      TEXT NOT NULL,
  engine_version   TEXT NOT NULL,
  created          INTEGER NOT NULL,            -- ms since 1970 UTC, as all times here
  started          INTEGER,
  finished         INTEGER,
  progress         TEXT NOT NULL DEFAULT '',
  failure_code     TEXT,
  failure_message  TEXT,
  failure_time     REAL,                        -- s of simulated time
  failure_x        REAL, failure_y REAL, failure_z REAL,
  retries          INTEGER NOT NULL DEFAULT 0,
  revision         INTEGER NOT NULL DEFAULT 1
);
CREATE INDEX runs_by_state ON runs (state, sequence);
CREATE TABLE results (
  run_id  TEXT NOT NULL REFERENCES runs (id) ON DELETE CASCADE,
  name    TEXT NOT NULL,
  bytes   INTEGER NOT NULL,
  sha256  TEXT NOT NULL,
  PRIMARY KEY (run_id, name)
);
CREATE TABLE idempotency_keys (
  key             TEXT PRIMARY KEY,
  request_sha256  TEXT NOT NULL,
  run_id          TEXT NOT NULL REFERENCES runs (id) ON DELETE CASCADE,
  created         INTEGER NOT NULL
);
PRAGMA user_version = 1;
)sql";

}  // namespace

void apply_store_schema(SQLite::Database& database) {
  SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
  const int found = database.execAndGet("PRAGMA user_version").getInt();
  if (found > schema_version)
    throw std::runtime_error("the state folder was written by a newer quicksand (schema " +
                             std::to_string(found) + ", this one knows " + std::to_string(schema_version) +
                             ")");
  if (found == 0) database.exec(schema);
  transaction.commit();
}

}  // namespace quicksand
