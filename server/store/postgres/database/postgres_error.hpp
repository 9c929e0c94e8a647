#pragma once

#include <array>
#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

namespace kinship::store::postgres {

/// Kinds of failures of a statement, by the action they call for. None of them is the fault of a
/// report: that was looked for before (store/rules), so none refuses one.
enum class ErrorKind {
  Lost,       ///< the connection, or the server, is gone: connect again
  Conflict,   ///< a deadlock or a serialization failure: the same transaction may be tried again
  Busy,       ///< a lock or a statement took too long: try again later
  ReadOnly,   ///< a standby, or a database that takes no writes: connect again, perhaps elsewhere
  NoRoom,     ///< disk, memory or connections of the server are used up: try again later
  OneRow,     ///< a constraint, a trigger or a sequence is against a row: that one is put off
  Forgotten,  ///< a prepared statement is not known: a pooler gave us another session
  Other       ///< whatever else: nothing is written until somebody has mended it
};

/// What becomes of an SQLSTATE that begins like this, unless a longer beginning fits.
struct ErrorClass {
  std::string_view begin;
  ErrorKind kind;
  std::string_view name;
};

/// The classes of PostgreSQL 15, appendix A, and the codes in them that call for another action.
inline constexpr std::array kErrorClasses = {
    ErrorClass{"00", ErrorKind::Other, "successful completion"},
    ErrorClass{"01", ErrorKind::OneRow, "warning"},
    ErrorClass{"02", ErrorKind::OneRow, "no data"},
    ErrorClass{"03", ErrorKind::Other, "SQL statement not yet complete"},
    ErrorClass{"08", ErrorKind::Lost, "connection exception"},
    ErrorClass{"09", ErrorKind::OneRow, "triggered action exception"},
    ErrorClass{"0A", ErrorKind::Other, "feature not supported"},
    ErrorClass{"0B", ErrorKind::Other, "invalid transaction initiation"},
    ErrorClass{"0F", ErrorKind::OneRow, "locator exception"},
    ErrorClass{"0L", ErrorKind::Other, "invalid grantor"},
    ErrorClass{"0P", ErrorKind::Other, "invalid role specification"},
    ErrorClass{"0Z", ErrorKind::OneRow, "diagnostics exception"},
    ErrorClass{"20", ErrorKind::OneRow, "case not found"},
    ErrorClass{"21", ErrorKind::OneRow, "cardinality violation"},
    ErrorClass{"22", ErrorKind::OneRow, "data exception"},
    ErrorClass{"23", ErrorKind::OneRow, "integrity constraint violation"},
    ErrorClass{"24", ErrorKind::Other, "invalid cursor state"},
    ErrorClass{"25", ErrorKind::Other, "invalid transaction state"},
    ErrorClass{"25006", ErrorKind::ReadOnly, "read-only transaction"},
    ErrorClass{"25P03", ErrorKind::Lost, "idle-in-transaction session timeout"},
    ErrorClass{"26", ErrorKind::Other, "invalid SQL statement name"},
    ErrorClass{"26000", ErrorKind::Forgotten, "invalid SQL statement name"},
    ErrorClass{"27", ErrorKind::OneRow, "triggered data change violation"},
    ErrorClass{"28", ErrorKind::Other, "invalid authorization specification"},
    ErrorClass{"2B", ErrorKind::Other, "dependent privilege descriptors still exist"},
    ErrorClass{"2D", ErrorKind::Other, "invalid transaction termination"},
    ErrorClass{"2F", ErrorKind::OneRow, "SQL routine exception"},
    ErrorClass{"34", ErrorKind::Other, "invalid cursor name"},
    ErrorClass{"38", ErrorKind::OneRow, "external routine exception"},
    ErrorClass{"39", ErrorKind::OneRow, "external routine invocation exception"},
    ErrorClass{"3B", ErrorKind::Other, "savepoint exception"},
    ErrorClass{"3D", ErrorKind::Other, "invalid catalog name"},
    ErrorClass{"3F", ErrorKind::Other, "invalid schema name"},
    ErrorClass{"40", ErrorKind::Other, "transaction rollback"},
    ErrorClass{"40001", ErrorKind::Conflict, "serialization failure"},
    ErrorClass{"40002", ErrorKind::OneRow, "transaction integrity constraint violation"},
    ErrorClass{"40P01", ErrorKind::Conflict, "deadlock detected"},
    ErrorClass{"42", ErrorKind::Other, "syntax error or access rule violation"},
    ErrorClass{"42P05", ErrorKind::Forgotten, "duplicate prepared statement"},
    ErrorClass{"44", ErrorKind::OneRow, "WITH CHECK OPTION violation"},
    ErrorClass{"53", ErrorKind::NoRoom, "insufficient resources"},
    ErrorClass{"54", ErrorKind::OneRow, "program limit exceeded"},
    ErrorClass{"55", ErrorKind::Other, "object not in prerequisite state"},
    ErrorClass{"55P03", ErrorKind::Busy, "lock not available"},
    ErrorClass{"57", ErrorKind::Other, "operator intervention"},
    ErrorClass{"57014", ErrorKind::Busy, "query canceled"},
    ErrorClass{"57P", ErrorKind::Lost, "shutdown, crash, database dropped, idle session timeout"},
    ErrorClass{"58", ErrorKind::Other, "system error"},
    ErrorClass{"72", ErrorKind::Other, "snapshot failure"},
    ErrorClass{"F0", ErrorKind::Other, "configuration file error"},
    ErrorClass{"HV", ErrorKind::Other, "foreign data wrapper error"},
    ErrorClass{"P0", ErrorKind::OneRow, "PL/pgSQL error"},
    ErrorClass{"XX", ErrorKind::Other, "internal error"}};

/// The kind of an SQLSTATE by kErrorClasses; empty: the connection died without one.
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
