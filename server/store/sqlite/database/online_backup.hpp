#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "server/store/sqlite/database/database.hpp"

struct sqlite3_backup;

namespace kinship::store {

/// A copy of a database, made in steps between which the source's own connection may write: SQLite
/// copies changed pages again. (A write through another connection would restart the copy.) The
/// copy is as of the last step. Every method throws SqliteError.
class OnlineBackup {
 public:
  /// \param source  must live longer.
  /// \param target  an empty file; it is not synced.
  OnlineBackup(Database& source, const std::filesystem::path& target);
  OnlineBackup(const OnlineBackup&) = delete;
  OnlineBackup& operator=(const OnlineBackup&) = delete;
  ~OnlineBackup();

  /// Copies the next pages. Not to be called within a write transaction of the source.
  /// \return whether the copy is complete.
  bool step(int pages);
  bool is_held_up() const noexcept { return is_held_up_; }  ///< the last step met a lock
  double progress() const;                                  ///< 0 to 1

 private:
  struct Finish {
    void operator()(sqlite3_backup* backup) const noexcept;
  };
  Database target_;
  std::unique_ptr<sqlite3_backup, Finish> backup_;  // ends before its target closes
  bool is_held_up_ = false;
};

/// Makes a finished copy one plain file, without a WAL beside it.
void make_plain(const std::filesystem::path& copy);

/// Copies a whole database, not written meanwhile, into an empty file and makes it plain.
/// \throws SqliteError, also once another program has held a lock for five seconds.
void copy_database(Database& source, const std::filesystem::path& target,
                   const std::function<void(double)>& progress);

}  // namespace kinship::store
