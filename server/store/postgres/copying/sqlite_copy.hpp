#pragma once

#include <filesystem>
#include <functional>

#include "proto/types/result.hpp"
#include "server/store/postgres/database/connection.hpp"

namespace kinship::store::postgres {

/// Copies a store as of one instant into a new SQLite store, row by row under the same ids, while
/// reports go on. The copy has an epoch of its own. Only a complete file has that name; FILE.rows
/// takes as much space again meanwhile.
/// \param connection  not in a transaction.
/// \param progress    called now and then with 0 to 1; false ends the copy with nothing kept.
/// \return false if `progress` ended it; Conflict if the file exists.
/// \throws Failure(Storage) that names the file.
Result<bool> copy_to_sqlite(Connection& connection, const std::filesystem::path& file,
                            const std::function<bool(double)>& progress);

}  // namespace kinship::store::postgres
