#include "server/store/sqlite/database/checked_vfs.hpp"

#include <sqlite3.h>

#include <cstddef>
#include <cstdint>
#include <new>

#include "server/store/sqlite/database/checked_file.hpp"
#include "server/store/sqlite/database/statement.hpp"

namespace kinship::store {
namespace {

constexpr const char* kVfsName = "kinship-checked";

/// Tests put another one in the place of the system's.
sqlite3_vfs* base() { return sqlite3_vfs_find(nullptr); }

int open_file(sqlite3_vfs* /*vfs*/, const char* name, sqlite3_file* file, int flags,
              int* flags_out) {
  return open_checked(*base(), name, file, flags, flags_out);
}
int delete_file(sqlite3_vfs* /*vfs*/, const char* name, int sync_directory) {
  return base()->xDelete(base(), name, sync_directory);
}
int access_file(sqlite3_vfs* /*vfs*/, const char* name, int flags, int* result) {
  return base()->xAccess(base(), name, flags, result);
}
int full_name(sqlite3_vfs* /*vfs*/, const char* name, int size, char* out) {
  return base()->xFullPathname(base(), name, size, out);
}
int randomness(sqlite3_vfs* /*vfs*/, int size, char* out) {
  return base()->xRandomness(base(), size, out);
}
int sleep_for(sqlite3_vfs* /*vfs*/, int microseconds) {
  return base()->xSleep(base(), microseconds);
}
int current_time(sqlite3_vfs* /*vfs*/, double* time) { return base()->xCurrentTime(base(), time); }
int last_error(sqlite3_vfs* /*vfs*/, int size, char* out) {
  return base()->xGetLastError(base(), size, out);
}

sqlite3_vfs make_vfs() {
  sqlite3_vfs vfs{};
  vfs.iVersion = 1;
  vfs.szOsFile = kCheckedFileBytes;
  vfs.mxPathname = base()->mxPathname;
  vfs.zName = kVfsName;
  vfs.xOpen = open_file;
  vfs.xDelete = delete_file;
  vfs.xAccess = access_file;
  vfs.xFullPathname = full_name;
  vfs.xRandomness = randomness;
  vfs.xSleep = sleep_for;
  vfs.xCurrentTime = current_time;
  vfs.xGetLastError = last_error;
  return vfs;
}

}  // namespace

const char* checked_vfs() {
  static const bool kRegistered = [] {
    static sqlite3_vfs vfs = make_vfs();
    return sqlite3_vfs_register(&vfs, 0) == SQLITE_OK;
  }();
  return kRegistered ? kVfsName : nullptr;
}

void seal_if_empty(sqlite3& connection) {
  int reserve = static_cast<int>(kSealBytes);
  if (sqlite3_file_control(&connection, "main", kSealIfEmpty, nullptr) == SQLITE_OK)
    sqlite3_file_control(&connection, "main", SQLITE_FCNTL_RESERVE_BYTES, &reserve);
}

void set_sealed(sqlite3& connection, bool sealed) {
  sqlite3_file_control(&connection, "main", kSetSealed, &sealed);
}

bool is_sealed(sqlite3& connection) {
  bool sealed = false;
  sqlite3_file_control(&connection, "main", kTellSealed, &sealed);
  return sealed;
}

std::shared_ptr<PageDamage> damage_of(sqlite3& connection) {
  std::shared_ptr<PageDamage> damage;
  sqlite3_file_control(&connection, "main", kTellDamage, &damage);
  return damage;
}

void gather_wal_writes(sqlite3& connection) {
  constexpr std::int64_t kFull = 2;
  Statement synchronous(connection, "PRAGMA synchronous");
  if (!synchronous.step() || synchronous.column_integer(0) != kFull)
    return;
  sqlite3_file* wal = nullptr;
  if (sqlite3_file_control(&connection, "main", SQLITE_FCNTL_JOURNAL_POINTER, &wal) == SQLITE_OK &&
      wal != nullptr && wal->pMethods != nullptr)
    gather_writes(*wal);
}

}  // namespace kinship::store
