#include "server/store/maintenance.hpp"

#include <unistd.h>

#include <memory>
#include <string>
#include <system_error>

#include "server/store/sqlite/database/online_backup.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/database/wal_file.hpp"
#include "server/store/sqlite/files/store_file.hpp"
#include "server/store/sqlite/files/store_lock.hpp"
#include "server/store/sqlite/opening/connection.hpp"
#include "server/store/sqlite/opening/migrations.hpp"
#include "server/store/sqlite/upkeep/restoration.hpp"
#include "server/store/sqlite/upkeep/store_check.hpp"

namespace kinship::store {
namespace {

namespace fs = std::filesystem;

/// Failures of SQLite and of the file system say which store it was.
template <typename Verb>
auto naming(const fs::path& file, Verb verb) {
  const std::string prefix = "store '" + file.string() + "': ";
  try {
    return verb();
  } catch (const SqliteError& error) {
    throw Failure(error.code(), prefix + error.what());
  } catch (const fs::filesystem_error& error) {
    throw Failure(ErrorCode::Storage, prefix + error.what());
  }
}

/// Where the store is; a file that is missing is not made.
fs::path locate_present(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error) && !fs::is_symlink(file, error))
    throw Failure(ErrorCode::NotFound, "store '" + file.string() + "': there is no such file");
  return locate_store(file);
}

/// Rolls back the transaction of a process killed outside of WAL mode; no reader could do that.
fs::path without_journal(const fs::path& located) {
  if (fs::exists(located.string() + "-journal"))
    Database(located, Access::ReadWrite).integer("PRAGMA user_version");
  return located;
}

/// A store that is only read and left as it was, its WAL too if a server was killed.
class ReadStore {
 public:
  explicit ReadStore(const fs::path& located)
      : file_(located),
        lock_(located),
        had_wal_(fs::exists(located.string() + "-wal")),
        database_(open_reader(without_journal(located))) {}
  ReadStore(const ReadStore&) = delete;
  ReadStore& operator=(const ReadStore&) = delete;
  ~ReadStore() {
    database_.reset();
    if (!had_wal_)
      for (const char* const sidecar : {"-wal", "-shm"})
        unlink((file_.string() + sidecar).c_str());
  }

  Database& database() { return *database_; }

 private:
  fs::path file_;
  StoreLock lock_;
  bool had_wal_;
  std::unique_ptr<Database> database_;
};

}  // namespace

StoreCheck check_store(const fs::path& file, const Progress& progress) {
  return naming(file, [&] {
    ReadStore store(locate_present(file));
    const Transaction snapshot(store.database(), Transaction::Kind::Read);
    return check_database(store.database(), file, progress);
  });
}

std::uint64_t backup_store(const fs::path& file, const fs::path& copy, const Progress& progress) {
  return naming(file, [&] {
    ReadStore store(locate_present(file));
    if (known_schema(store.database(), file, embedded_migrations()) == 0)
      throw Failure(ErrorCode::Storage, "store '" + file.string() + "': is empty");
    files::NewFile target(copy, kNewDatabase);
    copy_database(store.database(), target.part(), progress);
    target.publish();
    return fs::file_size(copy);
  });
}

Restored restore_store(const fs::path& backup, const fs::path& file, const Progress& progress) {
  std::error_code error;
  if (!fs::exists(backup, error))
    throw Failure(ErrorCode::NotFound, "backup '" + backup.string() + "': there is no such file");
  return naming(file, [&] {
    const fs::path located = locate_store(file);
    const StoreLock lock(located);
    if (fs::equivalent(backup, located, error))
      throw Failure(ErrorCode::InvalidInput,
                    "backup '" + backup.string() + "': is the store that it shall replace");
    Restoration restoration(backup, located);
    restoration.prepare(progress);
    return restoration.replace();
  });
}

Repaired repair_store(const fs::path& file, const Progress& progress) {
  return naming(file, [&] {
    if (!fs::exists(file))
      static_cast<void>(locate_present(file));  // which says so
    // The lock first: beside one a damaged header is not judged.
    const fs::path located = fs::weakly_canonical(fs::absolute(file));
    const StoreLock lock(located);
    static_cast<void>(locate_present(file));
    // The old store is its own backup here: the rows read from it replace it.
    Restoration restoration(located, located);
    Repaired repaired = restoration.repair(progress);
    repaired.restored = restoration.replace();
    return repaired;
  });
}

Migrated migrate_store(const fs::path& file) {
  return naming(file, [&] {
    const fs::path located = locate_present(file);
    const StoreLock lock(located);
    Migrated migrated;
    make_wal_durable(located);
    const std::int64_t from = [&] {
      Database database(located, Access::ReadWrite);
      return known_schema(database, located, embedded_migrations());
    }();
    if (from == 0)
      throw Failure(ErrorCode::Storage, "store '" + file.string() + "': is empty");
    migrated.from = static_cast<std::uint32_t>(from);
    migrated.to = static_cast<std::uint32_t>(embedded_migrations().size());
    if (migrated.from < migrated.to)
      migrated.backup = backup_of_version(located, from);
    open_migrated(located, embedded_migrations());
    return migrated;
  });
}

}  // namespace kinship::store
