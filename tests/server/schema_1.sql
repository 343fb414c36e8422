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
