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

/// This server among the others of its database: it counts as alive, and keeps its rights to fit,
/// as long as it calls changes_since(). May be shared between threads.
class Presence {
 public:
  /// \param pool  outlives it.
  explicit Presence(ConnectionPool& pool) : pool_(pool) {}
  Presence(const Presence&) = delete;
  Presence& operator=(const Presence&) = delete;
  ~Presence();  ///< deregisters the server, so that others need not wait until it counts as dead

  const Uuid& server() const noexcept { return server_; }

  /// See Store. To be called at least every 2 s to keep the rights.
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
