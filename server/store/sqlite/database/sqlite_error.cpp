#include "server/store/sqlite/database/sqlite_error.hpp"

#include <sqlite3.h>

#include <cerrno>
#include <system_error>

#include "server/store/sqlite/database/checked_vfs.hpp"

namespace kinship::store {
namespace {

/// SQLite reports "disk is full" for its databases only, for files beside them "disk I/O error".
std::string lack_of_room(sqlite3& connection) {
  const int reason = sqlite3_system_errno(&connection);
  const bool is_io_error = (sqlite3_extended_errcode(&connection) & 0xFF) == SQLITE_IOERR;
  if (!is_io_error || (reason != ENOSPC && reason != EDQUOT && reason != EFBIG))
    return "";
  return ": " + std::generic_category().message(reason);
}

}  // namespace

bool SqliteError::concerns_one_row() const noexcept {
  const int primary = sqlite_code_ & 0xFF;
  return primary == SQLITE_CONSTRAINT || primary == SQLITE_TOOBIG || primary == SQLITE_MISMATCH;
}

bool SqliteError::is_damage() const noexcept {
  const int primary = sqlite_code_ & 0xFF;
  return primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB ||
         sqlite_code_ == SQLITE_IOERR_DATA || sqlite_code_ == SQLITE_IOERR_CORRUPTFS;
}

bool SqliteError::spares_transaction() const noexcept {
  return concerns_one_row() || sqlite_code_ == kDamagedPage;
}

void throw_sqlite_error(sqlite3& connection, std::string_view doing) {
  constexpr std::string_view::size_type kMaxShown = 80;
  std::string message = "SQLite: ";
  message += sqlite3_extended_errcode(&connection) == kDamagedPage
                 ? "the checksum of a page is wrong"
                 : sqlite3_errmsg(&connection);
  message += " (code " + std::to_string(sqlite3_extended_errcode(&connection));
  message += lack_of_room(connection) + ") in '";
  message += doing.substr(0, kMaxShown);
  message += "'";
  throw SqliteError(sqlite3_extended_errcode(&connection), message);
}

}  // namespace kinship::store
