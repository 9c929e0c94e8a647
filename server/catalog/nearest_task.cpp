#include "server/catalog/nearest_task.hpp"

#include <utility>
#include <vector>

#include "proto/types/limits.hpp"
#include "proto/types/nearest_name.hpp"

namespace kinship::catalog {

std::string nearest_task(const store::ExperienceStore& store, const std::string& task,
                         const std::function<bool(const TaskSummary&)>& is_candidate) {
  constexpr std::size_t kMaxLookedAt = 10'000;
  std::vector<std::string> names;
  std::string cursor;
  do {
    store::Page<TaskSummary> page = store.list_tasks(cursor, kMaxPageRows);
    for (TaskSummary& row : page.rows)
      if (row.task != task && (!is_candidate || is_candidate(row)))
        names.push_back(std::move(row.task));
    cursor = std::move(page.next_cursor);
  } while (!cursor.empty() && names.size() < kMaxLookedAt);
  return suggestion(task, names);
}

}  // namespace kinship::catalog
