#include "server/store/postgres/database/postgres_error.hpp"

namespace kinship::store::postgres {

// PostgreSQL 15, appendix A.
ErrorKind kind_of(std::string_view sqlstate) {
  if (sqlstate.empty() || sqlstate.starts_with("08"))
    return ErrorKind::Lost;
  // admin_shutdown, crash_shutdown, cannot_connect_now, database_dropped, idle_session_timeout;
  // idle_in_transaction_session_timeout
  if (sqlstate.starts_with("57P") || sqlstate == "25P03")
    return ErrorKind::Lost;
  if (sqlstate == "40001" || sqlstate == "40P01")
    return ErrorKind::Conflict;
  if (sqlstate == "55P03" || sqlstate == "57014")  // lock_not_available, query_canceled
    return ErrorKind::Busy;
  if (sqlstate == "25006")
    return ErrorKind::ReadOnly;
  if (sqlstate.starts_with("53"))
    return ErrorKind::NoRoom;
  if (sqlstate.starts_with("22") || sqlstate.starts_with("23"))
    return ErrorKind::OneRow;
  if (sqlstate == "26000" || sqlstate == "42P05")  // unknown, duplicate prepared statement
    return ErrorKind::Forgotten;
  return ErrorKind::Other;
}

}  // namespace kinship::store::postgres
