#include "server/store/postgres/rows/path_rows.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "server/store/values/clock.hpp"
#include "server/store/values/path_content.hpp"

namespace kinship::store::postgres {
namespace {

/// \return the id of the last row, nothing if there is none after it.
std::optional<std::int64_t> select_page(Connection& connection, const Digest& robot,
                                        std::string_view task, const PathRange& range,
                                        PathsRead& read) {
  const Rows rows =
      connection.query("SELECT " + std::string(kPathColumns) +
                           "FROM path WHERE task_id = (SELECT id FROM task WHERE name = $1)"
                           " AND robot_id = (SELECT id FROM robot WHERE digest = $2) AND id > $3"
                           " AND received_ms >= $4 AND retired_ms IS NULL AND damaged_ms IS NULL"
                           " ORDER BY id LIMIT $5",
                       task, Bytes(robot.bytes), range.after_id, range.since_ms,
                       static_cast<std::int64_t>(range.limit));
  for (const Row row : rows) {
    if (std::optional<StoredPath> path = read_path(row))
      read.paths.push_back(std::move(*path));
    else
      read.damaged.push_back(row.column_integer(PathColumn::kId));
  }
  if (rows.size() < static_cast<std::int64_t>(range.limit))
    return std::nullopt;
  return rows[rows.size() - 1].column_integer(PathColumn::kId);
}

}  // namespace

PathsRead select_paths(Connection& connection, const Digest& robot, std::string_view task,
                       const PathRange& range) {
  constexpr std::size_t kPage = 500;
  PathsRead read;
  PathRange next = range;
  while (read.paths.size() < range.limit) {
    next.limit = std::min(kPage, range.limit - read.paths.size());
    const std::optional<std::int64_t> last = select_page(connection, robot, task, next, read);
    if (!last)
      break;
    next.after_id = *last;
  }
  return read;
}

std::vector<std::int64_t> select_path_ids(Connection& connection, const Digest& robot,
                                          std::string_view task) {
  std::vector<std::int64_t> ids;
  for (const Row row :
       connection.query("SELECT id FROM path WHERE task_id = (SELECT id FROM task WHERE name = $1)"
                        " AND robot_id = (SELECT id FROM robot WHERE digest = $2)"
                        " AND retired_ms IS NULL AND damaged_ms IS NULL ORDER BY id",
                        task, Bytes(robot.bytes)))
    ids.push_back(row.column_integer(0));
  return ids;
}

void set_aside_paths(Connection& connection, const std::vector<std::int64_t>& paths) {
  connection.query(
      "SELECT 1 FROM experience WHERE (task_id, robot_id) IN"
      " (SELECT found.task_id, found.robot_id FROM unnest($1) AS wanted (id) CROSS JOIN LATERAL"
      "  (SELECT task_id, robot_id FROM path WHERE path.id = wanted.id OFFSET 0) AS found)"
      " ORDER BY task_id, robot_id FOR NO KEY UPDATE",
      paths);
  connection.query(
      "WITH aside AS (UPDATE path SET damaged_ms = $2 WHERE id = ANY($1) AND damaged_ms IS NULL"
      "  RETURNING task_id, robot_id, retired_ms),"
      " lost AS (SELECT task_id, robot_id, count(*) AS paths FROM aside WHERE retired_ms IS NULL"
      "  GROUP BY task_id, robot_id)"
      " UPDATE experience SET changed_in = pg_current_xact_id(), generation = generation + 1, "
      "paths = experience.paths - lost.paths"
      " FROM lost WHERE experience.task_id = lost.task_id AND experience.robot_id = lost.robot_id",
      paths, now_ms());
}

}  // namespace kinship::store::postgres
