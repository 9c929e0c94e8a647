#include "server/catalog/nearest_task.hpp"

#include <vector>

#include "proto/types/nearest_name.hpp"

namespace kinship::catalog {

std::string nearest_task(const store::ExperienceStore& store, const std::string& task, Of of) {
  constexpr std::size_t kMaxNames = 10'000;
  std::vector<std::string> names = store.task_names({.like = task,
                                                     .letters = max_edits(task),
                                                     .with_paths = of == Of::TasksWithPaths,
                                                     .limit = kMaxNames});
  std::erase(names, task);
  return suggestion(task, names);
}

std::string NearestTasks::find(const std::string& task) {
  const auto now = clock_.now();
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = known_.find(task); known != known_.end() && now < known->second.until)
      return known->second.text;
  }
  std::string text = nearest_task(store_, task, Of::TasksWithPaths);
  const std::lock_guard lock(mutex_);
  if (known_.size() >= kMaxNames)
    known_.clear();
  known_[task] = {text, now + kRemembered};
  return text;
}

}  // namespace kinship::catalog
