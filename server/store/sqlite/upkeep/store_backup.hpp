#pragma once

#include <filesystem>
#include <functional>

#include "proto/types/result.hpp"
#include "server/store/sqlite/database/writer.hpp"

namespace kinship::store {

/// Copies the database of a writer into a new file, in steps between its batches.
/// \param progress  called on the caller's thread with 0 to 1; false ends the copy.
/// \return false if `progress` ended it; Conflict if the file exists; Unavailable if another backup
///         is running.
/// \throws Failure(Storage) that names the file.
Result<bool> back_up(Writer& writer, const std::filesystem::path& file,
                     const std::function<bool(double)>& progress);

}  // namespace kinship::store
