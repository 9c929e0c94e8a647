#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/store/postgres/database/connection.hpp"

namespace kinship::store::postgres {

/// The known outcome of a transaction after its COMMIT.
enum class Certainty {
  Committed,     ///< done, and as durable as its connection asks for
  NotCommitted,  ///< undone
  InDoubt        ///< either: the connection died, or the wait for a standby was ended
};

struct CommitOutcome {
  Certainty certainty = Certainty::InDoubt;
  std::string why;                 ///< empty if it is committed
  std::string sqlstate = "40001";  ///< of what undid it
};

/// A transaction, rolled back on destruction unless it was ended.
class Transaction {
 public:
  enum class Kind {
    Snapshot,  ///< reads one state of the database, writes nothing (REPEATABLE READ)
    Write,     ///< READ COMMITTED: each statement sees the data committed when it begins
    Local      ///< the same, but its COMMIT waits for no standby
  };
  /// A writing transaction waits for a lock some seconds at most; its statements and its COMMIT
  /// have no time limit in the server, which would end a COMMIT that waits for a standby. For
  /// Write, synchronous_commit is on, or remote_apply if the server or the role say so.
  Transaction(Connection& connection, Kind kind);
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  ~Transaction();

  /// Waits without limit until the outcome is certain, as for a standby that is down, unless the
  /// interrupt of the connection is raised. Never throws.
  CommitOutcome commit() noexcept;

  /// Of Write: version of the schema, which stays that as long as the transaction lasts; 0: none.
  std::int64_t schema() const noexcept { return schema_; }

 private:
  Connection* connection_;
  std::int64_t schema_ = 0;
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
