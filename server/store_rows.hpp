#pragma once
// Reading run records; the caller holds the connection's lock.

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>

#include <optional>
#include <string>
#include <vector>

#include "server/store.hpp"

namespace quicksand {

/// What `read_run` expects after SELECT.
constexpr const char* run_columns =
    "sequence, id, state, name, label, case_sha256, engine_version, created, started, finished, progress, "
    "failure_code, failure_message, failure_time, failure_x, failure_y, failure_z, retries, revision, owner, "
    "priority, points, memory_bytes, estimated_s, expired, kind, budget_s";

StoredRun read_run(SQLite::Statement& row);
std::optional<StoredRun> find_run(SQLite::Database& database, const std::string& id);
/// Oldest first.
std::vector<StoredRun> runs_in(SQLite::Database& database, RunState state);
int count_in(SQLite::Database& database, RunState state);

}  // namespace quicksand
