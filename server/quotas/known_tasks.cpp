#include "server/quotas/known_tasks.hpp"

namespace kinship::quotas {

bool KnownTasks::has(const std::string& task) const {
  const std::lock_guard lock(mutex_);
  return tasks_.contains(task);
}

bool KnownTasks::add(const std::string& task) {
  const std::lock_guard lock(mutex_);
  if (tasks_.size() >= max_tasks_ && !tasks_.contains(task))
    tasks_.clear();
  return tasks_.insert(task).second;
}

}  // namespace kinship::quotas
