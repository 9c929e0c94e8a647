#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"
#include "server/store/values/consistency_token.hpp"

namespace kinship::store::postgres {

/// Identity of the cluster and the database: equal for a standby, different for a restored copy.
std::string identity_of(Connection& connection);

/// The epoch of a store, the position of this server's commits, and whether the point of a client's
/// consistency token is still in the database. Several servers write; each connection that writes
/// reports is a run, whose position its transactions raise by one in a row of their own. A token
/// names a run and a position. It covers all earlier commits: the log of PostgreSQL is one
/// sequence, and a promoted standby, or a database that was rolled back, has a prefix of it; so if
/// that commit exists, all earlier ones do. The row of the run tells whether it exists.
///
/// May be shared between threads, except methods that take a connection, which belongs to the
/// caller.
class History {
 public:
  /// Begins a run on a new connection. If the database has another identity than the stored one, or
  /// lacks commits of this object, a new epoch begins, unless another server noticed it before.
  /// \throws PostgresError, Failure(Storage).
  void begin_run(Connection& connection);

  /// In the transaction of a batch: writes the next position of the run and reads the epoch. Pass
  /// the result to committed() once the commit is certain.
  struct Step {
    Uuid epoch;
    std::uint64_t position = 0;
  };
  Step advance(Connection& connection) const;
  void committed(const Step& step);

  /// Reads whether another server began an epoch.
  void refresh(Connection& connection);

  Uuid epoch() const;
  Uuid run() const;  ///< the current run of this server
  StorePoint point() const;

  /// The point of a token, if it is of this epoch and not known to be in the database.
  std::optional<LogPosition> find_unconfirmed(const ConsistencyToken& token) const;
  /// Whether a unconfirmed point is lost. Remembers how far its run is known.
  bool is_gone(Connection& connection, const LogPosition& point) const;

  /// Begins a new epoch if a token is lost, in a writing transaction. \return the epoch, for
  /// adopt().
  struct Begun {
    Uuid epoch;
    std::string why;
  };
  std::optional<Begun> begin_epoch_if_lost(Connection& connection,
                                           const ConsistencyToken& token) const;
  void adopt(const Begun& begun);

  std::uint64_t rollbacks() const;  ///< noticed by this object
  std::string trouble() const;      ///< the last rollback, as text; empty: none

 private:
  struct State {
    Digest key;
    Uuid epoch;  // zero: none yet
    Uuid run;
    std::uint64_t position = 0;  // certain
    std::uint64_t rollbacks = 0;
    std::string trouble;
  };

  std::string find_loss(Connection& connection, const State& before, const Uuid& newest) const;

  mutable std::mutex mutex_;
  State state_;                                      // guarded by mutex_
  mutable std::map<Uuid, std::uint64_t> seen_runs_;  // guarded by mutex_: how far others are known
};

}  // namespace kinship::store::postgres
