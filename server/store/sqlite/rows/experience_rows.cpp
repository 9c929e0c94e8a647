#include "server/store/sqlite/rows/experience_rows.hpp"

#include <string>
#include <string_view>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store {

std::uint64_t ensure_experience(Database& database, const ExperienceKey& key) {
  {
    const auto query = database.cached("SELECT paths, " + database.is_intact("experience") +
                                       " FROM experience WHERE task_id = ? AND robot_id = ?");
    if (query->bind_all(key.task_id, key.robot_id).step()) {
      if (query->column_integer(1) == 0)
        throw damaged_row("the experience of robot " + std::to_string(key.robot_id) +
                          " with task " + std::to_string(key.task_id));
      return count_of(*query, 0);
    }
  }
  database.cached("INSERT INTO experience (task_id, robot_id) VALUES (?, ?)")
      ->bind_all(key.task_id, key.robot_id)
      .run();
  return 0;
}

void add_to_experience(Database& database, const ExperienceKey& key, const PairChange& change) {
  static const std::string update = [&change] {
    std::string set;
    for_each_sum(change, [&set](std::string_view mode, std::string_view column, auto /*change*/) {
      const std::string name = std::string(mode).append(column);
      set += (set.empty() ? "" : ", ") + name + " = " + name + " + ?";
    });
    return "UPDATE experience SET " + set + " WHERE task_id = ? AND robot_id = ?";
  }();
  const auto statement = database.cached(update);
  int place = 0;
  for_each_sum(change, [&](std::string_view /*mode*/, std::string_view /*column*/, auto added) {
    statement->bind(++place, added);
  });
  statement->bind(++place, key.task_id);
  statement->bind(++place, key.robot_id);
  statement->run();
}

void uncount_paths(Database& database, const ExperienceKey& key, std::int64_t paths) {
  database.cached("UPDATE experience SET paths = paths - ? WHERE task_id = ? AND robot_id = ?")
      ->bind_all(paths, key.task_id, key.robot_id)
      .run();
}

std::vector<ExperienceKey> select_experience(Database& database, const PairFilter& filter) {
  std::vector<Parameter> parameters;
  const std::string sql = "SELECT task_id, robot_id FROM experience WHERE TRUE" +
                          filter.condition(database, "experience", parameters) +
                          " ORDER BY task_id, robot_id";
  std::vector<ExperienceKey> keys;
  for (const Row& row : database.query_with(sql, parameters))
    keys.push_back({row.column_integer(0), row.column_integer(1)});
  return keys;
}

}  // namespace kinship::store
