#pragma once

#include <optional>
#include <string>

#include "server/store/postgres/database/connection.hpp"

namespace kinship::store::postgres {

/// What is known of a transaction after its COMMIT.
enum class Certainty {
  Committed,     ///< it is there, and as durable as its connection asks for
  NotCommitted,  ///< nothing of it is there
  InDoubt        ///< it may be there: the connection died, or the wait for a standby was ended
};

struct CommitOutcome {
  Certainty certainty = Certainty::InDoubt;
  std::string why;  ///< empty if it is committed
};

/// A transaction, rolled back on destruction unless it was ended.
class Transaction {
 public:
  enum class Kind {
    Snapshot,  ///< reads one state of the database, writes nothing (REPEATABLE READ)
    Write,     ///< READ COMMITTED: each statement sees what is committed when it begins
    Local      ///< the same, but its COMMIT waits for no standby
  };
  /// A writing one waits for a lock some seconds at most, and its statements and its COMMIT have no
  /// limit of time in the server: nothing there ends a COMMIT that waits for a standby. Durable
  /// means synchronous_commit = on, whatever the server or the role say, or remote_apply if they
  /// say so.
  Transaction(Connection& connection, Kind kind);
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  ~Transaction();

  /// Waits until it is certain, as long as that takes: for a standby that is down without end,
  /// unless the interrupt of the connection is raised. Throws nothing.
  CommitOutcome commit() noexcept;

 private:
  Connection* connection_;
  bool is_open_ = true;
};

/// A part of a writing transaction that can be undone alone; undone on destruction unless kept.
class Savepoint {
 public:
  explicit Savepoint(Connection& connection);
  Savepoint(const Savepoint&) = delete;
  Savepoint& operator=(const Savepoint&) = delete;
  ~Savepoint();

  void keep();

 private:
  Connection* connection_;
  bool is_open_ = true;
};

}  // namespace kinship::store::postgres
