#pragma once

#include <cstdint>

#include "server/store/sqlite/database/writer.hpp"
#include "server/store/store.hpp"
#include "server/store/values/prepared_attempt.hpp"

namespace kinship::store {

/// Writes one report into the batch as server/store/rules resolves it. A path or scene that an
/// earlier receipt covers and that cannot be read any more is quarantined and written again.
/// \param max_paths  of its robot and task; 0: no cap.
/// \throws SqliteError; the caller must undo the writes made by then.
Receipt write_report(Batch& batch, const PreparedAttempt& prepared, std::uint64_t max_paths = 0);

}  // namespace kinship::store
