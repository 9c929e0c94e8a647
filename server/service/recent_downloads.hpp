#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <tuple>

#include "proto/types/backup_summary.hpp"

namespace kinship::service {

/// Backups whose digest or bytes a client has requested since the server started, so that the audit
/// log has an entry: a client reads a backup piece by piece, and that is one entry. Only the latest
/// are known; an older one gets a second entry. May be shared between threads.
class RecentDownloads {
 public:
  static constexpr std::size_t kKept = 1024;

  bool has(const std::string& client, const BackupSummary& backup) const {
    const std::lock_guard lock(mutex_);
    return std::ranges::find(known_, key_of(client, backup)) != known_.end();
  }

  void add(const std::string& client, const BackupSummary& backup) {
    const std::lock_guard lock(mutex_);
    known_.push_back(key_of(client, backup));
    if (known_.size() > kKept)
      known_.pop_front();
  }

 private:
  /// Another file of the same name is another backup.
  using Key = std::tuple<std::string, std::string, std::int64_t, std::uint64_t>;

  static Key key_of(const std::string& client, const BackupSummary& backup) {
    return {client, backup.name, backup.modified_ms, backup.bytes};
  }

  mutable std::mutex mutex_;
  std::deque<Key> known_;  // guarded by mutex_, the oldest first
};

}  // namespace kinship::service
