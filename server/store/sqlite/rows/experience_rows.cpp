#include "server/store/sqlite/rows/experience_rows.hpp"

#include <string>

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
  const auto integer = [](std::uint64_t count) { return static_cast<std::int64_t>(count); };
  const ModeTotals& guided = change.guided;
  const ModeTotals& control = change.control;
  database
      .cached(
          "UPDATE experience SET attempts = attempts + ?3, paths = paths + ?4,"
          " dropped = dropped + ?5, guided_attempts = guided_attempts + ?6,"
          " guided_solved = guided_solved + ?7, guided_checks = guided_checks + ?8,"
          " guided_checks_squared = guided_checks_squared + ?9,"
          " guided_checks_of_solved = guided_checks_of_solved + ?10,"
          " control_attempts = control_attempts + ?11, control_solved = control_solved + ?12,"
          " control_checks = control_checks + ?13,"
          " control_checks_squared = control_checks_squared + ?14,"
          " control_checks_of_solved = control_checks_of_solved + ?15"
          " WHERE task_id = ?1 AND robot_id = ?2")
      ->bind_all(key.task_id, key.robot_id, change.attempts, change.paths, change.dropped,
                 integer(guided.attempts), integer(guided.solved), guided.checks,
                 guided.checks_squared, guided.checks_of_solved, integer(control.attempts),
                 integer(control.solved), control.checks, control.checks_squared,
                 control.checks_of_solved)
      .run();
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
