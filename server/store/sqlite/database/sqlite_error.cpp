#include "server/store/sqlite/database/sqlite_error.hpp"

#include <sqlite3.h>

#include <cerrno>
#include <system_error>

namespace kinship::store {
namespace {

/// SQLite reports "disk is full" for its databases only, for files beside them "disk I/O error".
std::string out_of_space_reason(sqlite3& connection) {
  const int reason = sqlite3_system_errno(&connection);
  const bool is_io_error = (sqlite3_extended_errcode(&connection) & 0xFF) == SQLITE_IOERR;
  if (!is_io_error || (reason != ENOSPC && reason != EDQUOT && reason != EFBIG))
    return "";
  return ": " + std::generic_category().message(reason);
}

}  // namespace

bool SqliteError::concerns_one_row() const noexcept {
  const int primary = sqlite_code_ & 0xFF;
  return (primary == SQLITE_CONSTRAINT && !is_damage()) || primary == SQLITE_TOOBIG ||
         primary == SQLITE_MISMATCH;
}

bool SqliteError::is_busy() const noexcept { return (sqlite_code_ & 0xFF) == SQLITE_BUSY; }

bool SqliteError::is_damage() const noexcept {
  const int primary = sqlite_code_ & 0xFF;
  return primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB ||
         sqlite_code_ == SQLITE_CONSTRAINT_PRIMARYKEY ||  // of a number that should be new
         sqlite_code_ == SQLITE_CONSTRAINT_ROWID || sqlite_code_ == SQLITE_IOERR_DATA ||
         sqlite_code_ == SQLITE_IOERR_CORRUPTFS;
}

SqliteError damaged_row(const std::string& what) {
  return {kDamagedRow, what + kRowIsDamaged.data()};
}

void throw_sqlite_error(sqlite3& connection, std::string_view doing) {
  constexpr std::string_view::size_type kMaxShown = 80;
  std::string message = "SQLite: ";
  message += sqlite3_errmsg(&connection);
  message += " (code " + std::to_string(sqlite3_extended_errcode(&connection));
  message += out_of_space_reason(connection) + ") in '";
  message += doing.substr(0, kMaxShown);
  message += "'";
  const bool is_of_row = std::string_view(sqlite3_errmsg(&connection)).ends_with(kRowIsDamaged);
  throw SqliteError(is_of_row ? kDamagedRow : sqlite3_extended_errcode(&connection), message);
}

}  // namespace kinship::store
