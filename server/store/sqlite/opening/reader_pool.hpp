#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/transaction.hpp"

namespace kinship::store {

/// Read-only connections, lent to one thread at a time. May be shared between threads.
class ReaderPool {
  using Clock = std::chrono::steady_clock;

 public:
  explicit ReaderPool(std::filesystem::path file) : file_(std::move(file)) {}

  /// A connection with a snapshot of the database, while the lease lives. Keep it short: the WAL
  /// cannot be reset while a connection reads from it.
  class Lease {
   public:
    /// \throws SqliteError if no snapshot can be taken; the connection is closed then.
    explicit Lease(ReaderPool& pool);
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease();
    Database& operator*() const noexcept { return *database_; }
    Database* operator->() const noexcept { return database_.get(); }

   private:
    ReaderPool* pool_;
    Clock::time_point since_;
    std::unique_ptr<Database> database_;
    std::unique_ptr<Transaction> snapshot_;
  };

  /// Waits while all connections are lent.
  /// \throws Failure(Storage) if the pool is suspended and not resumed within a second: so a server
  ///         answers with an error while the disk hangs.
  Lease lease();

  /// Age of the oldest running reading; nothing if there is none.
  std::optional<Clock::duration> longest_reading() const;

  /// Waits for the leases to end and closes every connection; lease() waits until resume().
  void suspend();
  /// The same, and until resume() lease() throws NotTheFile with the reason, at once.
  void refuse(const std::string& why);
  void resume();

 private:
  static constexpr std::size_t kMaxConnections = 4;

  /// \param since  set to the time of the loan.
  std::unique_ptr<Database> take(Clock::time_point& since);
  void give_back(std::unique_ptr<Database> database, Clock::time_point since);

  const std::filesystem::path file_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::unique_ptr<Database>> idle_;  // guarded by mutex_, like all below
  std::multiset<Clock::time_point> lent_;        // when each was
  bool suspended_ = false;
  std::string refused_;  // while it is suspended: why; may be empty
};

}  // namespace kinship::store
