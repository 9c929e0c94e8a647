#include "server/store/postgres/opening/begin_store.hpp"

#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/opening/migrations.hpp"

namespace kinship::store::postgres {

std::unique_ptr<Connection> begin_store(Primary& primary, History& history) {
  constexpr int kTries = 3;
  for (int tries = 1;; ++tries) {
    try {
      std::unique_ptr<Connection> connection = primary.connect();
      migrate(*connection, embedded_migrations());
      history.begin_run(*connection);
      return connection;
    } catch (const PostgresError& error) {
      if (error.kind() != ErrorKind::Forgotten || tries == kTries)
        throw;
    }
  }
}

}  // namespace kinship::store::postgres
