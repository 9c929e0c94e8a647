#include "server/store/sqlite/upkeep/restoration.hpp"

#include <fcntl.h>
#include <sqlite3.h>
#include <stdio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "server/store/sqlite/database/online_backup.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/database/wal_file.hpp"
#include "server/store/sqlite/files/leftovers.hpp"
#include "server/store/sqlite/files/store_file.hpp"
#include "server/store/sqlite/opening/connection.hpp"
#include "server/store/sqlite/opening/high_water_mark_file.hpp"
#include "server/store/sqlite/opening/history.hpp"
#include "server/store/sqlite/opening/migrations.hpp"
#include "server/store/sqlite/upkeep/schema_recovery.hpp"
#include "server/store/sqlite/upkeep/store_check.hpp"
#include "server/store/sqlite/upkeep/store_repair.hpp"
#include "server/store/tables/audit.hpp"
#include "server/store/values/audit_texts.hpp"

namespace kinship::store {
namespace {

namespace fs = std::filesystem;

void remove_with_sidecars(const fs::path& file) {
  for (const char* const sidecar : kSidecars)
    unlink((file.string() + sidecar).c_str());
  unlink((file.string() + std::string(SchemaCopy::kSuffix)).c_str());
  unlink(file.c_str());
}

[[noreturn]] void fail(const fs::path& file, const std::string& doing, int error) {
  throw Failure(ErrorCode::Storage,
                "store '" + file.string() + "': " + doing + ": " + std::strerror(error));
}

void require(int error, const fs::path& file, const std::string& doing) {
  if (error != 0)
    fail(file, doing, error);
}

/// Files that earlier restores left beside a store.
std::vector<fs::path> replaced_stores(const fs::path& file) {
  const std::string prefix = file.filename().string() + ".replaced-";
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(file.parent_path()))
    if (entry.path().filename().string().starts_with(prefix))
      found.push_back(entry.path());
  std::ranges::sort(found);
  return found;
}

/// The epoch of the store that was served at a place, for one that has lost its own; zeros: none is
/// known.
Uuid epoch_at(const fs::path& file) {
  const fs::path mark = HighWaterMarkFile::name_of(file);
  const auto known = fs::exists(mark) ? HighWaterMarkFile(file).read() : std::nullopt;
  return known ? known->epoch : Uuid{};
}

/// The file that a restore replaces need not be a store.
bool has_audit(Database& database) {
  return database.integer("SELECT count(*) FROM sqlite_master WHERE name = 'audit'") > 0;
}

/// Adds the entries that the log of `other` has and that of `database` lacks, in their order, with
/// their times. None if `other` is no store.
void copy_missing_audit(Database& database, Database& other) {
  if (!has_audit(other))
    return;
  const std::string columns =
      "time_ms, name, role, client, is_local, verb, target, outcome, was, became, message";
  constexpr int kColumns = 11;
  const auto insert =
      database.cached("INSERT INTO audit (" + columns +
                      ") SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11 "
                      "WHERE NOT EXISTS (SELECT 1 FROM audit WHERE id = ?12 AND (" +
                      columns + ") = (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11))");
  Statement rows(
      other.connection(),
      "SELECT " + columns + ", id FROM audit WHERE " +
          (other.checked_tables().contains("audit") ? other.is_intact("audit") : "TRUE") +
          " ORDER BY id");
  while (rows.step()) {
    for (int column = 0; column <= kColumns; ++column)
      insert->bind_column(column + 1, rows, column);
    insert->run();
    insert->reset();
  }
}

}  // namespace

Restoration::Restoration(fs::path backup, fs::path file)
    : backup_(std::move(backup)), file_(std::move(file)), copy_(file_.string() + ".restoring") {
  remove_with_sidecars(copy_);
}

Restoration::~Restoration() { remove_with_sidecars(copy_); }

void Restoration::prepare(const std::function<void(double)>& progress) {
  constexpr double kCopyShare = 0.3;
  make_for_owner(copy_);
  const std::string named = "backup '" + backup_.string() + "': ";
  try {
    {
      const std::unique_ptr<Database> source = open_reader(backup_);
      if (known_schema(*source, backup_, embedded_migrations()) == 0)
        throw Failure(ErrorCode::Storage, named + "is empty");
      copy_database(*source, copy_, [&](double done) { progress(kCopyShare * done); });
    }
    {
      const std::unique_ptr<Database> opened =
          open_migrated(copy_, embedded_migrations(), Keep::Nothing);
      Database& database = *opened;
      epoch_ = write_new_epoch(database, copy_, epoch_at(file_));
      const StoreCheck check = check_database(
          database, backup_, [&](double done) { progress(kCopyShare + (1 - kCopyShare) * done); });
      if (check.problems > 0)
        throw Failure(ErrorCode::Storage,
                      named + std::to_string(check.problems) +
                          " problems, nothing was restored; the first: " + check.messages.front());
      keep_audit_of_old(database);
      insert_audit(database,
                   entry_of_maintenance("restore", backup_.string(), "", "epoch " + epoch_.text()));
    }
    files::sync_file(copy_);
  } catch (const SqliteError& error) {
    throw Failure(ErrorCode::Storage, named + error.what());
  }
}

/// Entries since the backup outlive the store that they are about.
void Restoration::keep_audit_of_old(Database& database) const {
  if (!fs::exists(file_))
    return;
  make_wal_durable(file_);
  Transaction whole(database, Transaction::Kind::Write);
  try {
    Database old(file_, Access::ReadOnly);
    copy_missing_audit(database, old);
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;  // a damaged store is restored, too: its log as far as it can be read
  }
  whole.commit();
}

Repaired Restoration::repair(const std::function<void(double)>& progress) {
  constexpr double kSalvageShare = 0.6;
  make_for_owner(copy_);
  fold_old();
  Repaired repaired;
  {
    const std::unique_ptr<Database> target =
        open_migrated(copy_, embedded_migrations(), Keep::Nothing);
    // Half a copy is of no use, and a whole one is synced.
    target->execute("PRAGMA synchronous = OFF");
    Salvaged salvaged =
        salvage(file_, *target, copy_, [&](double done) { progress(kSalvageShare * done); });
    repaired.damaged_places = salvaged.damaged_places;
    repaired.lost = std::move(salvaged.lost);
    repaired.tables = std::move(salvaged.tables);
    epoch_ = write_new_epoch(*target, copy_,
                             salvaged.epoch != Uuid{} ? salvaged.epoch : epoch_at(file_));
    insert_audit(*target, entry_of_maintenance("repair", file_.string(), "",
                                               "epoch " + epoch_.text() + ", " +
                                                   std::to_string(repaired.damaged_places) +
                                                   " damaged places were left behind"));
    repaired.check = check_database(
        *target, file_, [&](double done) { progress(kSalvageShare + (1 - kSalvageShare) * done); });
  }
  files::sync_file(copy_);
  return repaired;
}

Restored Restoration::replace() {
  Restored restored;
  restored.epoch = epoch_;
  restored.leftovers = replaced_stores(file_);
  HighWaterMarkFile::remove(file_);  // of the old store: it would take the new one for rolled back
  if (fs::exists(file_)) {
    fold_old();
    restored.replaced = name_copy();
    move_sidecars(file_, restored.replaced);
    exchange(restored.replaced);
  } else {
    move_sidecars(file_, file_.string() + ".replaced-" + time_stamp());
    require(files::rename_new(copy_, file_), file_, "cannot be named");
  }
  files::sync_folder_of(file_);
  return restored;
}

/// Brings the WAL of a killed server into the old store, so that it is one file. A store that
/// SQLite cannot read is kept as it is.
void Restoration::fold_old() {
  make_wal_durable(file_);
  try {
    Database database(file_, Access::ReadWrite);
    sqlite3_exec(&database.connection(), "PRAGMA schema_version", nullptr, nullptr, nullptr);
    sqlite3_wal_checkpoint_v2(&database.connection(), "main", SQLITE_CHECKPOINT_TRUNCATE, nullptr,
                              nullptr);  // also if the schema cannot be read
    database.execute("PRAGMA journal_mode = DELETE");
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
  }
}

fs::path Restoration::name_copy() const {
  const std::string wanted = file_.string() + ".replaced-" + time_stamp();
  constexpr int kTries = 100;
  for (int number = 1; number <= kTries; ++number) {
    const fs::path name = number == 1 ? wanted : wanted + "-" + std::to_string(number);
    const int error = files::rename_new(copy_, name);
    if (error == 0)
      return name;
    if (error != EEXIST)
      fail(name, "cannot be named", error);
  }
  fail(wanted, "cannot be named", EEXIST);
}

void Restoration::exchange(const fs::path& replaced) const {
  if (renameat2(AT_FDCWD, replaced.c_str(), AT_FDCWD, file_.c_str(), RENAME_EXCHANGE) == 0)
    return;
  if (errno != EINVAL && errno != ENOSYS)
    fail(file_, "cannot be replaced", errno);
  // A file system without exchange: the old store has two names for a moment.
  require(files::rename_new(replaced, copy_), copy_, "cannot be named");
  if (link(file_.c_str(), replaced.c_str()) != 0)
    fail(replaced, "cannot be named", errno);
  if (std::rename(copy_.c_str(), file_.c_str()) != 0)
    fail(file_, "cannot be replaced", errno);
}

}  // namespace kinship::store
