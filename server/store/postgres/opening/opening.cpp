#include "server/store/postgres/opening/opening.hpp"

#include <string>

#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/opening/migrations.hpp"
#include "server/store/postgres/rows/fit_lease_rows.hpp"
#include "server/store/tables/settings.hpp"
#include "server/store/values/move_marks.hpp"

namespace kinship::store::postgres {
namespace {

void enter(Connection& connection, const Uuid& server) {
  note_alive(connection, server);
  const std::string moving_from = read_setting(connection, kMovingFrom);
  const std::string moved_to = read_setting(connection, kMovedTo);
  if (moving_from.empty() && moved_to.empty())
    return;
  note_gone(connection, server);
  refuse_moving_store("it", moving_from, moved_to);
}

}  // namespace

void require_usable(Connection& connection) {
  constexpr int kOldest = 130000;
  constexpr std::string_view kNotSupported = "0A000", kReadOnly = "25006";
  if (connection.server_version() < kOldest)
    throw PostgresError(kNotSupported, "PostgreSQL " + connection.parameter("server_version") +
                                           " is too old, 13 or newer is needed");
  if (const std::string encoding = connection.parameter("server_encoding"); encoding != "UTF8")
    throw PostgresError(kNotSupported,
                        "the database is encoded as " + encoding +
                            ", UTF8 is needed (CREATE DATABASE ... ENCODING 'UTF8')");
  const Rows state =
      connection.query("SELECT pg_is_in_recovery(), current_setting('transaction_read_only')");
  if (state.front().column_integer(0) != 0)
    throw PostgresError(kReadOnly,
                        "it is a standby, which takes no writes; name the primary, or all "
                        "hosts (postgresql://A,B/DATABASE), of which the primary is taken");
  if (state.front().column_text(1) == "on")
    throw PostgresError(kReadOnly,
                        "it takes no writes (default_transaction_read_only is on for this role)");
}

std::unique_ptr<Connection> open_store_connection(const ConnectionString& where,
                                                  const ConnectionOptions& options) {
  auto connection = std::make_unique<Connection>(where, options);
  require_usable(*connection);
  migrate(*connection, embedded_migrations());
  return connection;
}

std::unique_ptr<Connection> begin_store(Primary& primary, History& history, const Uuid& server) {
  constexpr int kTries = 3;
  for (int tries = 1;; ++tries) {
    try {
      std::unique_ptr<Connection> connection = primary.connect();
      migrate(*connection, embedded_migrations());
      enter(*connection, server);
      history.begin_run(*connection);
      return connection;
    } catch (const PostgresError& error) {
      if (error.kind() != ErrorKind::Forgotten || tries == kTries)
        throw;
    }
  }
}

}  // namespace kinship::store::postgres
