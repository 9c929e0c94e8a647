#pragma once

#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

struct sqlite3;

namespace kinship::store {

/// The code of damaged_row(): one of SQLITE_CORRUPT that SQLite itself does not know.
inline constexpr int kDamagedRow = 11 | (75 << 8);

/// Ends the messages of damaged_row(), and of the triggers of row_checksums.
inline constexpr std::string_view kRowIsDamaged = ": its row is damaged (checksum)";

/// The error of a failed SQLite call: a Failure(Storage) with the result code.
class SqliteError : public Failure {
 public:
  SqliteError(int sqlite_code, const std::string& message)
      : Failure(ErrorCode::Storage, message), sqlite_code_(sqlite_code) {}

  int sqlite_code() const noexcept { return sqlite_code_; }  ///< extended result code

  /// True if one row was wrong (a constraint, a value too big) and the database is fine. After any
  /// other error (I/O error, full disk) nothing may be written before a reopen.
  bool concerns_one_row() const noexcept;

  /// True if another program holds a lock for longer than was waited: nothing was written, and the
  /// connection is fine.
  bool is_busy() const noexcept;

  /// True if the data to be read is damaged: a row with a wrong checksum that was to be changed, or
  /// content that SQLite finds malformed, after which a transaction takes no writes. Rows on other
  /// pages are fine.
  bool is_damage() const noexcept;
  /// True if it is damaged_row(), also from a trigger: its part of a transaction can be undone.
  bool is_of_row() const noexcept { return sqlite_code_ == kDamagedRow; }

 private:
  int sqlite_code_;
};

/// A row of a table, named by `what`, is not as it was written.
SqliteError damaged_row(const std::string& what);

/// Throws the connection's last error; `doing` names the operation.
[[noreturn]] void throw_sqlite_error(sqlite3& connection, std::string_view doing);

}  // namespace kinship::store
