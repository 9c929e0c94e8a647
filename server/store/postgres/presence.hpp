#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string_view>

#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/postgres/database/connection_pool.hpp"
#include "server/store/store.hpp"

namespace kinship::store::postgres {

/// This server among the others of its database: it is alive as long as it looks what they did, and
/// has the right to fit what it fits for as long. May be shared between threads.
class Presence {
 public:
  /// \param pool  outlives it.
  explicit Presence(ConnectionPool& pool) : pool_(pool) {}
  Presence(const Presence&) = delete;
  Presence& operator=(const Presence&) = delete;
  ~Presence();  ///< from now on it is not there: nobody waits until it counts as dead

  const Uuid& server() const noexcept { return server_; }

  /// See Store. Called at least every 2 s by who wants to keep its rights.
  StoreChanges changes_since(std::string_view cursor);
  std::optional<FitRight> take_fit_right(const Digest& id);
  void give_back_fit_right(const Digest& id, const FitRight& right) noexcept;

 private:
  void note_alive();

  ConnectionPool& pool_;
  const Uuid server_ = Uuid::random();
  std::mutex mutex_;
  std::chrono::steady_clock::time_point noted_{};  // guarded by mutex_
};

}  // namespace kinship::store::postgres
