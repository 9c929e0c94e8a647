#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <set>
#include <vector>

namespace kinship::store {

/// The damaged pages of one database file that this process has met. May be shared between threads.
class PageDamage {
 public:
  static constexpr std::size_t kMaxPages = 1000;

  /// \param page  counted from 1. Beyond kMaxPages no more are noted.
  void note(std::uint64_t page) {
    const std::lock_guard lock(mutex_);
    if (pages_.size() < kMaxPages)
      pages_.insert(page);
  }
  /// It was written anew.
  void forget(std::uint64_t page) {
    const std::lock_guard lock(mutex_);
    pages_.erase(page);
  }
  /// In order.
  std::vector<std::uint64_t> pages() const {
    const std::lock_guard lock(mutex_);
    return {pages_.begin(), pages_.end()};
  }

 private:
  mutable std::mutex mutex_;
  std::set<std::uint64_t> pages_;  // guarded by mutex_
};

}  // namespace kinship::store
