#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
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

  using Connect = std::function<std::unique_ptr<Connection>()>;
  explicit ConnectionPool(Connect connect) : connect_(std::move(connect)) {}

  /// Runs `write(Connection&)` once.
  template <typename Write>
  auto use(Write write) {
    const Lease lease(*this);
    return write(*lease);
  }

  /// Runs `read(Connection&)`; each statement sees the data committed when it begins. On a dead
  /// connection, as after a failover, it runs once more on a new one: it must not write.
  /// \throws PostgresError.
  template <typename Read>
  auto read(Read read) {
    return try_twice([&](Connection& connection) { return read(connection); });
  }

  /// The same; all statements see one state of the database.
  template <typename Read>
  auto read_snapshot(Read read) {
    return try_twice([&](Connection& connection) {
      const Transaction snapshot(connection, Transaction::Kind::Snapshot);
      return read(connection);
    });
  }

  /// Stops lending the connections made until now: their server is not the primary any more.
  void forget();

 private:
  /// A connection on loan.
  class Lease {
   public:
    explicit Lease(ConnectionPool& pool) : pool_(&pool), connection_(pool.take(version_)) {}
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease() { pool_->give_back(std::move(connection_), version_); }
    Connection& operator*() const noexcept { return *connection_; }

   private:
    ConnectionPool* pool_;
    std::uint64_t version_ = 0;
    std::unique_ptr<Connection> connection_;
  };

  template <typename Read>
  auto try_twice(Read read) {
    try {
      const Lease lease(*this);
      return read(*lease);
    } catch (const PostgresError& error) {
      if (error.kind() != ErrorKind::Lost && error.kind() != ErrorKind::Forgotten)
        throw;
    }
    forget();
    const Lease lease(*this);
    return read(*lease);
  }

  /// \param version  set to that of the connection.
  std::unique_ptr<Connection> take(std::uint64_t& version);
  void give_back(std::unique_ptr<Connection> connection, std::uint64_t version) noexcept;

  const Connect connect_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::unique_ptr<Connection>> idle_;  // guarded by mutex_
  std::size_t lent_ = 0;                           // guarded by mutex_
  std::uint64_t version_ = 0;                      // guarded by mutex_: grows with forget()
};

}  // namespace kinship::store::postgres
