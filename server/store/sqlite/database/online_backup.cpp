#include "server/store/sqlite/database/online_backup.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <string>

#include "server/store/sqlite/database/sqlite_error.hpp"

namespace kinship::store {

void OnlineBackup::Finish::operator()(sqlite3_backup* backup) const noexcept {
  sqlite3_backup_finish(backup);
}

OnlineBackup::OnlineBackup(Database& source, const std::filesystem::path& target)
    : target_(target, Access::ReadWrite) {
  // The caller that publishes the copy syncs it; half a copy is of no use.
  target_.execute("PRAGMA synchronous = OFF; PRAGMA journal_mode = MEMORY");
  backup_.reset(sqlite3_backup_init(&target_.connection(), "main", &source.connection(), "main"));
  if (!backup_)
    throw_sqlite_error(target_.connection(), "backup");
}

OnlineBackup::~OnlineBackup() = default;

bool OnlineBackup::step(int pages) {
  const int code = sqlite3_backup_step(backup_.get(), pages);
  // Busy or locked: nothing was copied; the next step tries again.
  is_held_up_ = code == SQLITE_BUSY || code == SQLITE_LOCKED;
  if (code == SQLITE_OK || is_held_up_)
    return false;
  if (code != SQLITE_DONE)
    throw SqliteError(code, std::string("backup: ") + sqlite3_errstr(code));
  return true;
}

double OnlineBackup::progress() const {
  const int pages = std::max(sqlite3_backup_pagecount(backup_.get()), 1);
  return 1 - static_cast<double>(sqlite3_backup_remaining(backup_.get())) / pages;
}

void make_plain(const std::filesystem::path& copy) {
  Database(copy, Access::ReadWrite).execute("PRAGMA journal_mode = DELETE");
}

void copy_database(Database& source, const std::filesystem::path& target,
                   const std::function<void(double)>& progress) {
  constexpr int kPagesOfAStep = 1024, kTriesWhenHeldUp = 500, kPauseWhenHeldUp_ms = 10;
  {
    OnlineBackup backup(source, target);
    int held_up = 0;  // in succession
    while (!backup.step(kPagesOfAStep)) {
      held_up = backup.is_held_up() ? held_up + 1 : 0;
      if (held_up > kTriesWhenHeldUp)
        throw SqliteError(SQLITE_BUSY, "backup: another program holds a lock");
      if (held_up > 0)
        sqlite3_sleep(kPauseWhenHeldUp_ms);
      progress(backup.progress());
    }
  }
  make_plain(target);
  progress(1);
}

}  // namespace kinship::store
