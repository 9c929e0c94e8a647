#pragma once

#include <cstdint>

#include "server/store/postgres/database/connection.hpp"

namespace kinship::store::postgres {

/// Which primary it is of those that a cluster had: a standby that is promoted has a greater one.
/// It is in the name of the file that is being written; the control file tells it later. \throws
/// PostgresError, also of a standby.
inline std::int64_t timeline_of(Connection& connection) {
  return connection
      .query(
          "SELECT ('x' || substr(pg_walfile_name(pg_current_wal_insert_lsn()), 1, 8))"
          "::bit(32)::bigint")
      .front()
      .column_integer(0);
}

}  // namespace kinship::store::postgres
