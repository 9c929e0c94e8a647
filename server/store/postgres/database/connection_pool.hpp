#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/database/transaction.hpp"

namespace kinship::store::postgres {

/// Connections for readings, lent to one thread at a time. May be shared between threads.
class ConnectionPool {
 public:
  static constexpr std::size_t kMaxConnections = 4;

  ConnectionPool(ConnectionString where, const ConnectionOptions& options)
      : where_(std::move(where)), options_(options) {}

  /// Runs `read(Connection&)`, each statement of which sees what is committed when it begins. Where
  /// the connection turns out to be dead, as after a failover, once more on a new one: it must not
  /// write.
  /// \throws PostgresError.
  template <typename Read>
  auto read(Read read) {
    return try_twice([&](Connection& connection) { return read(connection); });
  }

  /// The same, all statements of which see one state of the database.
  template <typename Read>
  auto read_snapshot(Read read) {
    return try_twice([&](Connection& connection) {
      const Transaction snapshot(connection, Transaction::Kind::Snapshot);
      return read(connection);
    });
  }

  /// Connections that nobody uses are closed: the server behind them is gone.
  void forget_idle();

 private:
  /// A connection on loan.
  class Lease {
   public:
    explicit Lease(ConnectionPool& pool) : pool_(&pool), connection_(pool.take()) {}
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease() { pool_->give_back(std::move(connection_)); }
    Connection& operator*() const noexcept { return *connection_; }

   private:
    ConnectionPool* pool_;
    std::unique_ptr<Connection> connection_;
  };

  template <typename Read>
  auto try_twice(Read read) {
    try {
      const Lease lease(*this);
      return read(*lease);
    } catch (const PostgresError& error) {
      if (error.kind() != ErrorKind::Lost)
        throw;
    }
    forget_idle();
    const Lease lease(*this);
    return read(*lease);
  }

  std::unique_ptr<Connection> take();
  void give_back(std::unique_ptr<Connection> connection) noexcept;

  const ConnectionString where_;
  const ConnectionOptions options_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::unique_ptr<Connection>> idle_;  // guarded by mutex_
  std::size_t lent_ = 0;                           // guarded by mutex_
};

}  // namespace kinship::store::postgres
