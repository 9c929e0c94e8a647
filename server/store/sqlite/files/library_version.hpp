#pragma once

#include <string>

namespace kinship::store {

/// The SQLite that the schema needs (STRICT tables, 3.37.0) as sqlite3_libversion_number() has it.
inline constexpr int kOldestSqlite = 3'037'000;

/// Nothing for an SQLite that can serve a store.
/// \param number  sqlite3_libversion_number(): major * 1'000'000 + minor * 1000 + patch
/// \throws Failure(Storage) with both versions for an older one.
void require_library(int number);

/// What to mind with this SQLite; empty if nothing. Before 3.51.3 a WAL may be corrupted when one
/// process writes and another checkpoints.
std::string library_advice(int number);

}  // namespace kinship::store
