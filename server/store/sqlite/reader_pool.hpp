#pragma once

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include "server/store/sqlite/database.hpp"
#include "server/store/sqlite/transaction.hpp"

namespace kinship::store {

/// Read-only connections, lent to one thread at a time. May be shared between threads.
class ReaderPool {
 public:
  explicit ReaderPool(std::filesystem::path file) : file_(std::move(file)) {}

  /// A connection with a snapshot of the database, while it lives. Keep it short: the WAL cannot
  /// be reset as long as somebody reads from it.
  class Lease {
   public:
    Lease(ReaderPool& pool, std::unique_ptr<Database> database);
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease();
    Database& operator*() const noexcept { return *database_; }
    Database* operator->() const noexcept { return database_.get(); }

   private:
    ReaderPool* pool_;
    std::unique_ptr<Database> database_;
    std::unique_ptr<Transaction> snapshot_;
  };

  /// Waits while all connections are lent or the pool is suspended.
  Lease lease();

  /// Waits for the leases to end and closes every connection; lease() waits until resume().
  void suspend();
  void resume();

 private:
  static constexpr std::size_t kMaxConnections = 4;

  std::unique_ptr<Database> take();
  void give_back(std::unique_ptr<Database> database);

  const std::filesystem::path file_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::unique_ptr<Database>> idle_;  // guarded by mutex_, like all below
  std::size_t lent_ = 0;
  bool suspended_ = false;
};

}  // namespace kinship::store
