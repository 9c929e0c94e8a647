#pragma once

#include <filesystem>
#include <optional>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/files/wal_frames.hpp"

namespace kinship::store {

/// Writes the content of a store's WAL again, as read, and syncs it. After a failed fsync Linux
/// reads from memory data that is on no disk: without this the next connection would take such
/// frames for durable and write behind them, and after a power cut the WAL would end before all
/// later frames. To be called while no connection has the store open and before one opens it for
/// writing. Other programs do not write meanwhile: it holds SQLite's lock.
/// \throws Failure(Storage), SqliteError; the WAL reads as before then.
void make_wal_durable(const std::filesystem::path& file);

/// The wal-index as this connection and all others share it, in a few copies of memory. Nothing
/// while another program writes it, or in a format that is not known.
std::optional<WalIndex> read_wal_index(Database& database);

enum class CheckpointKind {
  Passive,  ///< as far as possible without waiting for readers
  Whole     ///< all frames, which empties the WAL; nothing if another connection reads from it
};

/// Copies frames of the WAL into the database file and syncs it.
/// \return whether all frames of the WAL are in the database file.
/// \throws SqliteError if the disk failed; the WAL then still holds all frames.
bool checkpoint(Database& database, CheckpointKind kind);

}  // namespace kinship::store
