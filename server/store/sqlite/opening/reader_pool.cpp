#include "server/store/sqlite/opening/reader_pool.hpp"

#include <utility>

#include "proto/types/failure.hpp"
#include "server/store/sqlite/files/named_store.hpp"
#include "server/store/sqlite/opening/connection.hpp"

namespace kinship::store {

ReaderPool::Lease::Lease(ReaderPool& pool) : pool_(&pool), database_(pool.take(since_)) {
  try {
    snapshot_ = std::make_unique<Transaction>(*database_, Transaction::Kind::Read);
  } catch (...) {
    pool_->give_back(nullptr, since_);
    throw;
  }
}

ReaderPool::Lease::~Lease() {
  snapshot_.reset();
  pool_->give_back(std::move(database_), since_);
}

ReaderPool::Lease ReaderPool::lease() { return Lease(*this); }

std::optional<ReaderPool::Clock::duration> ReaderPool::longest_reading() const {
  const std::lock_guard lock(mutex_);
  if (lent_.empty())
    return std::nullopt;
  return Clock::now() - *lent_.begin();
}

std::unique_ptr<Database> ReaderPool::take(Clock::time_point& since) {
  constexpr std::chrono::seconds kLongestSuspension{1};
  std::unique_lock lock(mutex_);
  do {
    const bool is_over = changed_.wait_for(lock, kLongestSuspension,
                                           [this] { return !suspended_ || !refused_.empty(); });
    if (!refused_.empty())
      throw NotTheFile(refused_);
    if (!is_over)
      throw Failure(ErrorCode::Storage, "the store is being opened again after a failure");
    changed_.wait(lock, [this] { return suspended_ || lent_.size() < kMaxConnections; });
  } while (suspended_);
  since = Clock::now();
  lent_.insert(since);
  if (!idle_.empty()) {
    std::unique_ptr<Database> database = std::move(idle_.back());
    idle_.pop_back();
    return database;
  }
  lock.unlock();
  try {
    return open_reader(file_);
  } catch (...) {
    give_back(nullptr, since);
    throw;
  }
}

void ReaderPool::give_back(std::unique_ptr<Database> database, Clock::time_point since) {
  const std::lock_guard lock(mutex_);
  lent_.erase(lent_.find(since));
  if (database)
    idle_.push_back(std::move(database));
  changed_.notify_all();
}

void ReaderPool::refuse(const std::string& why) {
  {
    const std::lock_guard lock(mutex_);
    refused_ = why;
  }
  suspend();
}

void ReaderPool::suspend() {
  std::unique_lock lock(mutex_);
  suspended_ = true;
  changed_.notify_all();
  changed_.wait(lock, [this] { return lent_.empty(); });
  idle_.clear();
}

void ReaderPool::resume() {
  const std::lock_guard lock(mutex_);
  suspended_ = false;
  refused_.clear();
  changed_.notify_all();
}

}  // namespace kinship::store
