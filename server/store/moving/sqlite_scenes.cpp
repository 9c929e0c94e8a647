#include "server/store/moving/sqlite_scenes.hpp"

#include <algorithm>

namespace kinship::store::moving {

SqliteScenes::SqliteScenes(Database& database) {
  const auto query = database.cached(
      "SELECT id, replaced_by FROM set_aside WHERE kind = 3 AND replaced_by > id ORDER BY id");
  while (query->step())
    replaced_by_[query->column_integer(0)] = query->column_integer(1);
  for (const auto& [id, next] : replaced_by_)
    first_.emplace(last_of(id), id);  // by falling age: the first that leads there stays
}

std::int64_t SqliteScenes::last_of(std::int64_t id) const {
  // A row is replaced by a later one, so this ends.
  for (auto next = replaced_by_.find(id); next != replaced_by_.end(); next = replaced_by_.find(id))
    id = next->second;
  return id;
}

std::int64_t SqliteScenes::first_of(std::int64_t id) const {
  const std::int64_t last = last_of(id);
  const auto found = first_.find(last);
  return found == first_.end() ? last : found->second;
}

}  // namespace kinship::store::moving
