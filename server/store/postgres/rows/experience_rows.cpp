#include "server/store/postgres/rows/experience_rows.hpp"

namespace kinship::store::postgres {

void lock_pair(Connection& connection, const ExperienceKey& key) {
  connection.query(
      "SELECT 1 FROM experience WHERE task_id = $1 AND robot_id = $2"
      " FOR NO KEY UPDATE",
      key.task_id, key.robot_id);
}

void note_retirement(Connection& connection, const ExperienceKey& key, std::int64_t paths) {
  connection.query(
      "UPDATE experience SET changed_in = pg_current_xact_id(), generation = generation + 1,"
      " retired_generation = generation + 1, paths = paths - $3"
      " WHERE task_id = $1 AND robot_id = $2",
      key.task_id, key.robot_id, paths);
}

}  // namespace kinship::store::postgres
