#pragma once

#include <string>
#include <type_traits>
#include <utility>

#include "proto/types/failure.hpp"
#include "server/store/postgres/database/connection_pool.hpp"
#include "server/store/postgres/database/transaction.hpp"
#include "server/store/postgres/opening/migrations.hpp"
#include "server/store/postgres/report_writer.hpp"

namespace kinship::store::postgres {

/// Changes that a caller waits for, each a transaction. May be shared between threads.
class DurableWrites {
 public:
  /// \param require_synchronous  every commit needs a synchronous standby.
  DurableWrites(ConnectionPool::Connect connect, bool require_synchronous)
      : pool_(std::move(connect)), require_synchronous_(require_synchronous) {}

  /// Runs `function(Connection&)` in a transaction, again after a conflict with another server or
  /// on a dead connection, and returns when it is durable.
  /// \throws PostgresError; Failure(Storage) if the outcome of the commit is not certain.
  template <typename Function>
  std::invoke_result_t<Function, Connection&> write(Function function) {
    constexpr int kTries = 5;
    for (int tries = 1;; ++tries) {
      try {
        return pool_.use([&](Connection& connection) { return commit(connection, function); });
      } catch (const PostgresError& error) {
        if (error.kind() == ErrorKind::Lost || error.kind() == ErrorKind::Forgotten)
          pool_.forget();
        const bool may_go_on = error.kind() == ErrorKind::Conflict ||
                               error.kind() == ErrorKind::Forgotten ||
                               (error.kind() == ErrorKind::Lost && tries == 1);
        if (!may_go_on || tries == kTries)
          throw;
      }
    }
  }

  /// See ConnectionPool.
  void forget() { pool_.forget(); }

 private:
  template <typename Function>
  std::invoke_result_t<Function, Connection&> commit(Connection& connection, Function& function) {
    Transaction transaction(connection, Transaction::Kind::Write);
    require_schema(transaction.schema());
    if (require_synchronous_)
      require_standby(connection);
    auto value = function(connection);
    const CommitOutcome outcome = transaction.commit();
    if (outcome.certainty == Certainty::NotCommitted)
      throw PostgresError(outcome.sqlstate, outcome.why);
    if (outcome.certainty == Certainty::InDoubt) {
      connection.abandon();
      throw Failure(ErrorCode::Storage, "it is not certain whether it is done: " + outcome.why);
    }
    return value;
  }

  ConnectionPool pool_;
  const bool require_synchronous_;
};

}  // namespace kinship::store::postgres
