#pragma once

#include <filesystem>
#include <functional>

#include "proto/types/result.hpp"
#include "server/store/postgres/database/connection.hpp"

namespace kinship::store::postgres {

/// Writes all that a store has as of one instant into a new SQLite store, row by row under the same
/// ids, while reports go on. It is of an epoch of its own. A file that is not complete never has
/// that name; FILE.rows takes as much again meanwhile.
/// \param connection  in no transaction.
/// \param progress    called now and then with 0 to 1; false ends the copy with nothing kept.
/// \return false if `progress` ended it; Conflict if the file is there already.
/// \throws Failure(Storage) that names the file.
Result<bool> copy_to_sqlite(Connection& connection, const std::filesystem::path& file,
                            const std::function<bool(double)>& progress);

}  // namespace kinship::store::postgres
