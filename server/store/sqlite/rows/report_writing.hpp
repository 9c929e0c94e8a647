#pragma once

#include <cstdint>

#include "server/store/sqlite/database/writer.hpp"
#include "server/store/store.hpp"
#include "server/store/values/prepared_attempt.hpp"

namespace kinship::store {

/// Writes one report into the batch as server/store/rules resolves it. What a receipt vouches for
/// and cannot be read any more is set aside and written anew.
/// \param max_paths  of its robot and task; 0: no cap.
/// \throws SqliteError; what was written by then is the caller's to undo.
Receipt write_report(Batch& batch, const PreparedAttempt& prepared, std::uint64_t max_paths = 0);

}  // namespace kinship::store
