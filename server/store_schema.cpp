#include "server/store_schema.hpp"

#include <SQLiteCpp/Transaction.h>

#include <array>
#include <stdexcept>
#include <string>

namespace quicksand {
namespace {

/// Each step brings a database from one version to the next; `PRAGMA user_version` counts them. A step that
/// was released never changes.
constexpr const char* version_1 = R"sql(
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
)sql";

constexpr const char* version_2 = R"sql(
ALTER TABLE runs ADD COLUMN owner        TEXT NOT NULL DEFAULT '';    -- name of the API key, '' without keys
ALTER TABLE runs ADD COLUMN priority     INTEGER NOT NULL DEFAULT 0;
ALTER TABLE runs ADD COLUMN points       INTEGER NOT NULL DEFAULT 0;  -- of the plan; 0: not planned yet
ALTER TABLE runs ADD COLUMN memory_bytes REAL NOT NULL DEFAULT 0;     -- of the plan
ALTER TABLE runs ADD COLUMN estimated_s  REAL NOT NULL DEFAULT 0;     -- of the plan
ALTER TABLE runs ADD COLUMN expired      INTEGER;                     -- when the files were removed by policy
CREATE INDEX runs_by_owner ON runs (owner, started);
CREATE INDEX runs_by_end ON runs (finished);
CREATE TABLE api_keys (
  id       TEXT PRIMARY KEY,
  name     TEXT NOT NULL,
  role     TEXT NOT NULL CHECK (role IN ('read', 'submit', 'admin')),
  sha256   TEXT NOT NULL,                       -- of the secret part
  created  INTEGER NOT NULL,
  revoked  INTEGER
);
CREATE TABLE owned_keys (
  owner           TEXT NOT NULL,
  key             TEXT NOT NULL,
  request_sha256  TEXT NOT NULL,
  run_id          TEXT NOT NULL REFERENCES runs (id) ON DELETE CASCADE,
  created         INTEGER NOT NULL,
  PRIMARY KEY (owner, key)
);
INSERT INTO owned_keys SELECT '', key, request_sha256, run_id, created FROM idempotency_keys;
DROP TABLE idempotency_keys;
ALTER TABLE owned_keys RENAME TO idempotency_keys;
)sql";

constexpr const char* version_3 = R"sql(
ALTER TABLE runs ADD COLUMN kind     TEXT NOT NULL DEFAULT 'run' CHECK (kind IN ('run', 'tradeoff'));
ALTER TABLE runs ADD COLUMN budget_s REAL NOT NULL DEFAULT 0;         -- of CPU time, of a tradeoff
)sql";

constexpr std::array steps{version_1, version_2, version_3};
constexpr int schema_version = static_cast<int>(steps.size());

int version_of(SQLite::Database& database) { return database.execAndGet("PRAGMA user_version").getInt(); }

}  // namespace

void apply_store_schema(SQLite::Database& database) {
  SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
  const int found = version_of(database);
  if (found > schema_version)
    throw std::runtime_error("the state folder was written by a newer quicksand (schema " +
                             std::to_string(found) + ", this one knows " + std::to_string(schema_version) +
                             ")");
  for (int version = found; version < schema_version; ++version) database.exec(steps[version]);
  database.exec("PRAGMA user_version = " + std::to_string(schema_version));
  transaction.commit();
}

void require_store_schema(SQLite::Database& database) {
  if (const int found = version_of(database); found != schema_version)
    throw std::runtime_error("the state folder has schema " + std::to_string(found) +
                             ", this quicksand needs " + std::to_string(schema_version) +
                             ": start its server once, which brings it there");
}

}  // namespace quicksand
