#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_set>

namespace kinship::quotas {

/// Cache of tasks that the store has, so that not every report reads it. Bounded: it is cleared
/// when it is full. May be shared between threads.
class KnownTasks {
 public:
  explicit KnownTasks(std::size_t max_tasks = 65'536) : max_tasks_(max_tasks) {}

  bool has(const std::string& task) const;
  /// \return whether it was not known.
  bool add(const std::string& task);

 private:
  const std::size_t max_tasks_;
  mutable std::mutex mutex_;  // guards tasks_
  std::unordered_set<std::string> tasks_;
};

}  // namespace kinship::quotas
