#include "server/store/sqlite/reader_pool.hpp"

#include <utility>

#include "server/store/sqlite/connection.hpp"

namespace kinship::store {

ReaderPool::Lease::Lease(ReaderPool& pool, std::unique_ptr<Database> database)
    : pool_(&pool), database_(std::move(database)) {
  try {
    snapshot_ = std::make_unique<Transaction>(*database_, Transaction::Kind::Read);
  } catch (...) {
    pool_->give_back(nullptr);
    throw;
  }
}

ReaderPool::Lease::~Lease() {
  snapshot_.reset();
  pool_->give_back(std::move(database_));
}

ReaderPool::Lease ReaderPool::lease() { return {*this, take()}; }

std::unique_ptr<Database> ReaderPool::take() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !suspended_ && lent_ < kMaxConnections; });
  ++lent_;
  if (!idle_.empty()) {
    std::unique_ptr<Database> database = std::move(idle_.back());
    idle_.pop_back();
    return database;
  }
  lock.unlock();
  try {
    return open_reader(file_);
  } catch (...) {
    give_back(nullptr);
    throw;
  }
}

void ReaderPool::give_back(std::unique_ptr<Database> database) {
  const std::lock_guard lock(mutex_);
  --lent_;
  if (database)
    idle_.push_back(std::move(database));
  changed_.notify_all();
}

void ReaderPool::suspend() {
  std::unique_lock lock(mutex_);
  suspended_ = true;
  changed_.wait(lock, [this] { return lent_ == 0; });
  idle_.clear();
}

void ReaderPool::resume() {
  const std::lock_guard lock(mutex_);
  suspended_ = false;
  changed_.notify_all();
}

}  // namespace kinship::store
