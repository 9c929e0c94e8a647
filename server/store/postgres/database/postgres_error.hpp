#pragma once

#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

namespace kinship::store::postgres {

/// Kinds of failures of a statement, by the action they call for.
enum class ErrorKind {
  Lost,       ///< the connection, or the server, is gone: connect again
  Conflict,   ///< a deadlock or a serialization failure: the same transaction may be tried again
  Busy,       ///< a lock or a statement took too long: try again later
  ReadOnly,   ///< a standby, or a database that takes no writes
  NoRoom,     ///< disk, memory or connections of the server are used up
  OneRow,     ///< a value or a constraint: the database is fine, this row is not
  Forgotten,  ///< a prepared statement is not known: a pooler gave us another session
  Other
};

/// The kind of an SQLSTATE; empty: the connection died without one.
ErrorKind kind_of(std::string_view sqlstate);

/// The error of a failed call of PostgreSQL or libpq: a Failure(Storage) with the SQLSTATE.
class PostgresError : public Failure {
 public:
  /// \param sqlstate  empty: the connection died without one.
  PostgresError(std::string_view sqlstate, const std::string& message)
      : Failure(ErrorCode::Storage, message), sqlstate_(sqlstate), kind_(kind_of(sqlstate)) {}

  const std::string& sqlstate() const noexcept { return sqlstate_; }
  ErrorKind kind() const noexcept { return kind_; }

 private:
  std::string sqlstate_;
  ErrorKind kind_;
};

}  // namespace kinship::store::postgres
