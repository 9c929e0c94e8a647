#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "server/service/admin_page.hpp"
#include "server/service/reply_bytes.hpp"

namespace kinship::service {

/// The latest answers to changes, by request: a request sent again, e.g. after a lost reply, gets
/// the same answer and is neither executed nor logged again. May be shared between threads.
class AnsweredChanges {
 public:
  static constexpr std::size_t kKept = 256;
  /// Limit of all pages together, approximate. A larger page is not kept.
  static constexpr std::size_t kKeptBytes = std::size_t{1} << 20U;

  std::optional<AdminPage> find(const std::string& request_key) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(pages_, request_key, &Entry::key);
    return found == pages_.end() ? std::nullopt : std::optional<AdminPage>(found->page);
  }

  /// Does not keep a failed change: it may be tried again.
  void keep(const std::string& request_key, const AdminPage& page) {
    const std::size_t bytes = request_key.size() + page.message.size() + reply_bytes(page);
    if (request_key.empty() || page.status == AdminStatus::Failed || bytes > kKeptBytes)
      return;
    const std::lock_guard lock(mutex_);
    pages_.push_back({request_key, page, bytes});
    bytes_ += bytes;
    while (pages_.size() > kKept || bytes_ > kKeptBytes) {
      bytes_ -= pages_.front().bytes;
      pages_.pop_front();
    }
  }

  std::size_t bytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
  }

 private:
  struct Entry {
    std::string key;
    AdminPage page;
    std::size_t bytes;
  };

  mutable std::mutex mutex_;  // guards what follows
  std::deque<Entry> pages_;   // the oldest first
  std::size_t bytes_ = 0;
};

}  // namespace kinship::service
