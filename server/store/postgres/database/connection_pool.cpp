#include "server/store/postgres/database/connection_pool.hpp"

namespace kinship::store::postgres {

std::unique_ptr<Connection> ConnectionPool::take(std::uint64_t& version) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return lent_ < kMaxConnections; });
    ++lent_;
    version = version_;
    if (!idle_.empty()) {
      std::unique_ptr<Connection> connection = std::move(idle_.back());
      idle_.pop_back();
      return connection;
    }
  }
  try {
    return connect_();
  } catch (...) {
    give_back(nullptr, version);
    throw;
  }
}

void ConnectionPool::give_back(std::unique_ptr<Connection> connection,
                               std::uint64_t version) noexcept {
  const std::lock_guard lock(mutex_);
  --lent_;
  if (connection && version == version_ && connection->is_alive() && !connection->in_transaction())
    idle_.push_back(std::move(connection));
  changed_.notify_one();
}

void ConnectionPool::forget() {
  std::vector<std::unique_ptr<Connection>> dead;
  const std::lock_guard lock(mutex_);
  ++version_;
  dead.swap(idle_);
}

}  // namespace kinship::store::postgres
