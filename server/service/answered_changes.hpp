#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "server/service/admin_page.hpp"

namespace kinship::service {

/// The changes that were answered last, by the requests that asked for them: one that is sent
/// again, as after a lost reply, is answered as it was, neither done nor logged again. May be
/// shared between threads.
class AnsweredChanges {
 public:
  static constexpr std::size_t kKept = 256;

  std::optional<AdminPage> find(const std::string& request_key) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(pages_, request_key, &Entry::first);
    return found == pages_.end() ? std::nullopt : std::optional<AdminPage>(found->second);
  }

  /// What failed may be tried again, and jobs are known by themselves, as they stand.
  void keep(const std::string& request_key, const AdminPage& page) {
    const bool is_job = !page.rows.empty() && std::holds_alternative<Job>(page.rows.front());
    if (request_key.empty() || page.status == AdminStatus::Failed || is_job)
      return;
    const std::lock_guard lock(mutex_);
    pages_.emplace_back(request_key, page);
    if (pages_.size() > kKept)
      pages_.pop_front();
  }

 private:
  using Entry = std::pair<std::string, AdminPage>;

  mutable std::mutex mutex_;
  std::deque<Entry> pages_;  // guarded by mutex_, the oldest first
};

}  // namespace kinship::service
