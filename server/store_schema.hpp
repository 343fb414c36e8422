#pragma once
#include <SQLiteCpp/Database.h>

namespace quicksand {

/// Brings an empty database to the current schema. Throws std::runtime_error for a newer one.
void apply_store_schema(SQLite::Database& database);

}  // namespace quicksand
