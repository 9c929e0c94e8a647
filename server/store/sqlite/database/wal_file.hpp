#pragma once

#include <filesystem>

#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// Writes what a store's WAL holds once more, as it reads, and syncs it. After a failed fsync Linux
/// reads from memory what no disk has: without this the next connection would take such frames for
/// durable, write behind them, and a power cut would end the WAL before all that came later. To be
/// called while nobody has the store open and before anybody opens it for writing.
/// \throws Failure(Storage); the WAL reads as before then.
void make_wal_durable(const std::filesystem::path& file);

enum class CheckpointKind {
  Passive,  ///< as much as goes without waiting for readers
  Whole     ///< all of it, and the WAL is empty then; nothing if somebody else reads from it
};

/// Copies frames of the WAL into the database file and syncs it.
/// \return whether the WAL has no frame left that is not in the database file.
/// \throws SqliteError if the disk failed; the WAL still holds all of it then.
bool checkpoint(Database& database, CheckpointKind kind);

}  // namespace kinship::store
