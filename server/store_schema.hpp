#pragma once
#include <SQLiteCpp/Database.h>

namespace quicksand {

/// Brings an empty or older database to the current schema, in one transaction. Throws std::runtime_error for
/// a newer one.
void apply_store_schema(SQLite::Database& database);

/// Throws std::runtime_error unless the database has the current schema.
void require_store_schema(SQLite::Database& database);

}  // namespace quicksand
