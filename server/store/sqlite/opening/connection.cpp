#include "server/store/sqlite/opening/connection.hpp"

#include <sqlite3.h>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/database/wal_file.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/files/store_file.hpp"
#include "server/store/sqlite/opening/migrations.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/tables/settings.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/move_marks.hpp"

namespace kinship::store {
namespace {

constexpr std::int64_t kNewestRowsChecked = 64;

// The writer checkpoints between its batches, where it sees the outcome; SQLite's own automatic one
// drops errors. A second connection that does can corrupt the file in SQLite before 3.51.3.
void configure_writer(Database& database) {
  database.execute(
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;"
      "PRAGMA wal_autocheckpoint = 0; PRAGMA journal_size_limit = 67108864;"
      "PRAGMA mmap_size = 0; PRAGMA cell_size_check = ON;");
}

/// Not half a store, nor one that is elsewhere now.
void require_not_moving(Database& database, const std::filesystem::path& file) {
  refuse_moving_store("store '" + file.string() + "'", read_setting(database, kMovingFrom),
                      read_setting(database, kMovedTo));
}

/// After a crash SQLite does not know which frames of the WAL the file has, and nobody else does,
/// until a checkpoint.
void move_frames(Database& database) {
  try {
    checkpoint(database, CheckpointKind::Passive);
  } catch (const SqliteError&) {
    // No room: the WAL still has all.
  }
}

}  // namespace

std::unique_ptr<Database> open_writer(const std::filesystem::path& file) {
  make_for_owner(file);
  make_wal_durable(file);
  // A foreign file is refused before anything is written to it.
  std::unique_ptr<Database> database = open_migrated(file, embedded_migrations());
  require_not_moving(*database, file);
  configure_writer(*database);
  move_frames(*database);
  files::sync_folder_of(file);  // SQLite drops errors of that
  return database;
}

std::unique_ptr<Database> reopen_writer(const std::filesystem::path& file) {
  make_wal_durable(file);
  auto database = std::make_unique<Database>(file, Access::ReadWrite);
  configure_writer(*database);
  // The database file may have lost pages of a failed checkpoint: all are written again.
  if (!checkpoint(*database, CheckpointKind::Whole))
    throw Failure(ErrorCode::Storage, "another program reads the store and keeps its WAL");
  check_schema(*database, file, embedded_migrations());
  database->keep_checksums();
  Transaction probe(*database, Transaction::Kind::Write);
  write_setting(*database, "reopened_ms", std::to_string(now_ms()));
  Batch batch(*database);
  quarantine_paths(batch, find_damaged_paths(*database, kNewestRowsChecked));
  batch.raise_generations();
  probe.commit();
  files::sync_folder_of(file);
  return database;
}

std::unique_ptr<Database> open_reader(const std::filesystem::path& file, Access access) {
  auto database = std::make_unique<Database>(file, access);
  // Readers wait only for a recovery of the WAL.
  database->execute(
      "PRAGMA query_only = ON; PRAGMA wal_autocheckpoint = 0; PRAGMA mmap_size = 0;"
      "PRAGMA busy_timeout = 5000; PRAGMA cell_size_check = ON");
  return database;
}

std::unique_ptr<Database> open_unchanged(const std::filesystem::path& file) {
  const auto has = [&file](const char* sidecar) {
    return std::filesystem::exists(file.string() + sidecar);
  };
  const bool is_at_rest = !has("-wal") && !has("-journal");
  auto database = open_reader(file, is_at_rest ? Access::AtRest : Access::ReadOnly);
  sqlite3_db_config(&database->connection(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  return database;
}

}  // namespace kinship::store
