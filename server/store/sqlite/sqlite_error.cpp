#include "server/store/sqlite/sqlite_error.hpp"

#include <sqlite3.h>

namespace kinship::store {

bool SqliteError::concerns_one_row() const noexcept {
  const int primary = sqlite_code_ & 0xFF;
  return primary == SQLITE_CONSTRAINT || primary == SQLITE_TOOBIG || primary == SQLITE_MISMATCH;
}

void throw_sqlite_error(sqlite3& connection, std::string_view doing) {
  constexpr std::string_view::size_type kMaxShown = 80;
  std::string message = "SQLite: ";
  message += sqlite3_errmsg(&connection);
  message += " (code " + std::to_string(sqlite3_extended_errcode(&connection)) + ") in '";
  message += doing.substr(0, kMaxShown);
  message += "'";
  throw SqliteError(sqlite3_extended_errcode(&connection), message);
}

}  // namespace kinship::store
