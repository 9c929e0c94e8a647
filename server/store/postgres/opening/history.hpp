#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"
#include "server/store/values/history_seal.hpp"

namespace kinship::store::postgres {

/// Of the cluster and the database: a standby has the same, a copy that was restored has not.
std::string identity_of(Connection& connection);

/// Which epoch a store is in, how far this server's commits have come, and whether a point that
/// somebody was told of is still there. Several servers write; each connection that writes reports
/// is a run, whose position its transactions raise by one in a row of their own. A mark names a run
/// and a position. It vouches for all that was committed before: the log of PostgreSQL is one
/// sequence, of which a promoted standby, or a database that was put back, has a beginning; so what
/// was committed before is there if that one is. The row of the run says whether it is.
///
/// May be shared between threads, except where it takes a connection, which is the caller's.
class History {
 public:
  /// A run begins on a connection that was just made. If the database is not the one that it was,
  /// or lacks what this object saw committed, a new epoch begins, unless another server noticed it
  /// before. \throws PostgresError, Failure(Storage).
  void begin_run(Connection& connection);

  /// In the transaction of a batch: writes how far the run has come with it, and reads which epoch
  /// it is. What it returns is for committed(), once that is certain.
  struct Step {
    Uuid epoch;
    std::uint64_t position = 0;
  };
  Step advance(Connection& connection) const;
  void committed(const Step& step);

  /// Looks whether another server began an epoch.
  void refresh(Connection& connection);

  Uuid epoch() const;
  Uuid run() const;  ///< of this server now
  StorePoint point() const;

  /// The point that a mark names, if it is one of this epoch, and what is not known to be there.
  std::optional<HistoryPoint> find_doubtful(const HistoryMark& mark) const;
  /// Whether a doubtful point is gone. What is there is remembered.
  bool is_gone(Connection& connection, const HistoryPoint& point) const;

  /// A new epoch if a mark is lost, in a writing transaction. \return it, for adopt().
  struct Begun {
    Uuid epoch;
    std::string why;
  };
  std::optional<Begun> begin_epoch_if_lost(Connection& connection, const HistoryMark& mark) const;
  void adopt(const Begun& begun);

  std::uint64_t rollbacks() const;  ///< noticed by this object
  std::string trouble() const;      ///< what was noticed last, for people; empty: nothing

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
