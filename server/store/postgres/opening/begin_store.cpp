#include "server/store/postgres/opening/begin_store.hpp"

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
