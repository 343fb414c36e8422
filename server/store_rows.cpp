#include "server/store_rows.hpp"

#include <array>

namespace quicksand {
namespace {

constexpr std::array<const char*, 6> state_names{"queued",    "running", "canceling",
                                                 "succeeded", "failed",  "canceled"};

std::optional<Milliseconds> optional_time(const SQLite::Column& column) {
  if (column.isNull()) return {};
  return column.getInt64();
}

}  // namespace

const char* state_name(RunState state) { return state_names[static_cast<std::size_t>(state)]; }

const char* kind_name(RunKind kind) { return kind == RunKind::tradeoff ? "tradeoff" : "run"; }

std::optional<RunState> state_from_name(const std::string& name) {
  for (std::size_t i = 0; i < state_names.size(); ++i)
    if (name == state_names[i]) return static_cast<RunState>(i);
  return {};
}

bool is_active(RunState state) {
  return state == RunState::queued || state == RunState::running || state == RunState::canceling;
}

StoredRun read_run(SQLite::Statement& row) {
  StoredRun run;
  run.sequence = row.getColumn(0).getInt64();
  run.id = row.getColumn(1).getString();
  run.state = state_from_name(row.getColumn(2).getString()).value();
  run.name = row.getColumn(3).getString();
  run.label = row.getColumn(4).getString();
  run.case_sha256 = row.getColumn(5).getString();
  run.engine_version = row.getColumn(6).getString();
  run.created = row.getColumn(7).getInt64();
  run.started = optional_time(row.getColumn(8));
  run.finished = optional_time(row.getColumn(9));
  run.progress = row.getColumn(10).getString();
  if (!row.getColumn(11).isNull())
    run.failure = Failure{
        row.getColumn(11).getString(),
        row.getColumn(12).getString(),
        row.getColumn(13).getDouble(),
        {row.getColumn(14).getDouble(), row.getColumn(15).getDouble(), row.getColumn(16).getDouble()}};
  run.retries = row.getColumn(17).getInt();
  run.revision = row.getColumn(18).getInt64();
  run.owner = row.getColumn(19).getString();
  run.priority = row.getColumn(20).getInt();
  run.cost = {row.getColumn(21).getInt64(), row.getColumn(22).getDouble(), row.getColumn(23).getDouble()};
  run.expired = optional_time(row.getColumn(24));
  run.kind = row.getColumn(25).getString() == kind_name(RunKind::tradeoff) ? RunKind::tradeoff : RunKind::run;
  run.budget = row.getColumn(26).getDouble();
  return run;
}

std::optional<StoredRun> find_run(SQLite::Database& database, const std::string& id) {
  SQLite::Statement row(database, std::string("SELECT ") + run_columns + " FROM runs WHERE id = ?");
  row.bind(1, id);
  if (!row.executeStep()) return {};
  return read_run(row);
}

std::vector<StoredRun> runs_in(SQLite::Database& database, RunState state) {
  SQLite::Statement rows(
      database, std::string("SELECT ") + run_columns + " FROM runs WHERE state = ? ORDER BY sequence");
  rows.bind(1, state_name(state));
  std::vector<StoredRun> runs;
  while (rows.executeStep()) runs.push_back(read_run(rows));
  return runs;
}

int count_in(SQLite::Database& database, RunState state) {
  SQLite::Statement rows(database, "SELECT COUNT(*) FROM runs WHERE state = ?");
  rows.bind(1, state_name(state));
  rows.executeStep();
  return rows.getColumn(0).getInt();
}

}  // namespace quicksand
