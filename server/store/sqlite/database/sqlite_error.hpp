#pragma once

#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

struct sqlite3;

namespace kinship::store {

/// What an SQLite call said when it failed: a Failure(Storage) that remembers the result code.
class SqliteError : public Failure {
 public:
  SqliteError(int sqlite_code, const std::string& message)
      : Failure(ErrorCode::Storage, message), sqlite_code_(sqlite_code) {}

  int sqlite_code() const noexcept { return sqlite_code_; }  ///< extended result code

  /// True if one row was wrong (a constraint, a value too big) and the database is fine. Anything
  /// else (I/O error, full disk) says that nothing more may be written before a reopen.
  bool concerns_one_row() const noexcept;

  /// True if what was to be read is damaged: a page whose checksum is wrong, or content that SQLite
  /// makes no sense of. Rows on other pages are fine.
  bool is_damage() const noexcept;

  /// True if a savepoint undoes what was begun and the transaction goes on: what concerns one row,
  /// or needs a page whose checksum is wrong, which was not let in.
  bool spares_transaction() const noexcept;

 private:
  int sqlite_code_;
};

/// Throws the connection's last error; `doing` says during what.
[[noreturn]] void throw_sqlite_error(sqlite3& connection, std::string_view doing);

}  // namespace kinship::store
