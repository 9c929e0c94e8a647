#pragma once

#include <filesystem>
#include <functional>

#include "proto/types/store_check.hpp"
#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// Checks a store's database by reading all of it: SQLite's own structure, foreign keys, every
/// checksum, the counts of `experience` against the rows, and rows that lost their partner.
/// \param file  named in the result.
/// \throws Failure(Storage) if it is no store with a schema that this binary knows.
StoreCheck check_database(Database& database, const std::filesystem::path& file,
                          const std::function<void(double)>& progress);

}  // namespace kinship::store
