#pragma once

#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

struct sqlite3;

namespace kinship::store {

/// The error of a failed SQLite call: a Failure(Storage) with the result code.
class SqliteError : public Failure {
 public:
  SqliteError(int sqlite_code, const std::string& message)
      : Failure(ErrorCode::Storage, message), sqlite_code_(sqlite_code) {}

  int sqlite_code() const noexcept { return sqlite_code_; }  ///< extended result code

  /// True if one row was wrong (a constraint, a value too big) and the database is fine. After any
  /// other error (I/O error, full disk) nothing may be written before a reopen.
  bool concerns_one_row() const noexcept;

  /// True if the data to be read is damaged: a page with a wrong checksum, or content that SQLite
  /// finds malformed. Rows on other pages are fine.
  bool is_damage() const noexcept;

  /// True if a savepoint can undo the statement and the transaction goes on: the error concerns one
  /// row, or a page with a wrong checksum, which was not loaded.
  bool spares_transaction() const noexcept;

 private:
  int sqlite_code_;
};

/// Throws the connection's last error; `doing` names the operation.
[[noreturn]] void throw_sqlite_error(sqlite3& connection, std::string_view doing);

}  // namespace kinship::store
