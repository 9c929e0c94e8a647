#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>

namespace kinship::sites {

/// The tasks that robots of a site requested lately. May be shared between threads.
class UsedTasks {
 public:
  static constexpr std::chrono::hours kLately{1};
  static constexpr std::size_t kMaxTasks = 10'000;  ///< beyond that new ones are not noted

  /// \return whether it is new.
  bool note(const std::string& task, std::int64_t now_ms) {
    const std::lock_guard lock(mutex_);
    const auto found = tasks_.find(task);
    if (found != tasks_.end())
      found->second = now_ms;
    else if (tasks_.size() < kMaxTasks)
      return tasks_.emplace(task, now_ms).second;
    return false;
  }

  std::set<std::string> lately(std::int64_t now_ms) {
    constexpr std::int64_t kLately_ms = std::chrono::milliseconds(kLately).count();
    const std::lock_guard lock(mutex_);
    std::erase_if(tasks_, [&](const auto& task) { return now_ms - task.second > kLately_ms; });
    std::set<std::string> names;
    for (const auto& [name, used_ms] : tasks_)
      names.insert(name);
    return names;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::int64_t> tasks_;  // guarded by mutex_; when it was used last
};

}  // namespace kinship::sites
