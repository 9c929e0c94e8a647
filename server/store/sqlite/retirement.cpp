#include "server/store/sqlite/retirement.hpp"

#include <algorithm>
#include <vector>

#include "server/store/sqlite/clock.hpp"
#include "server/store/sqlite/experience_rows.hpp"
#include "server/store/sqlite/row_values.hpp"

namespace kinship::store {
namespace {

constexpr std::int64_t kPathsOfAStep = 500;  // each is written anew: about 10 MB of WAL

struct PathRow {
  std::int64_t id = 0;
  ExperienceKey key;
  Digest robot;
  bool damaged = false;
};

/// A damaged path was in fits before it was found damaged: it is retired as any other, but was
/// taken out of the count already.
void retire(Batch& batch, const PathRow& path, Retirement& retired) {
  Database& database = batch.database();
  database.cached("UPDATE path SET retired_ms = ? WHERE id = ?")->bind_all(now_ms(), path.id).run();
  if (!path.damaged)
    uncount_paths(database, path.key, 1);
  batch.paths_retired(path.key.task_id, path.key.robot_id);
  ++retired.paths;
  const auto place = std::ranges::lower_bound(retired.robots, path.robot);
  if (place == retired.robots.end() || *place != path.robot)
    retired.robots.insert(place, path.robot);
}

constexpr std::string_view kRetiredColumns =
    "SELECT path.id, path.task_id, path.robot_id, robot.digest, path.damaged FROM path ";

PathRow read_retired(const Statement& row) {
  return {row.column_integer(0),
          {row.column_integer(1), row.column_integer(2)},
          id_of<Digest>(row.column_blob(3)),
          row.column_integer(4) != 0};
}

/// \param condition  an index serves it; parameters ?1 task, ?2 last path, ?3 rows.
std::vector<PathRow> select_rows(Database& database, const TaskReset& reset,
                                 const std::string& condition, std::int64_t limit) {
  const auto query = database.cached(std::string(kRetiredColumns) + condition);
  query->bind_all(reset.task_id, reset.last_path_id, limit);
  std::vector<PathRow> rows;
  while (query->step())
    rows.push_back(read_retired(*query));
  return rows;
}

}  // namespace

Result<Retirement> retire_path(Batch& batch, const Uuid& report_uuid) {
  Database& database = batch.database();
  Retirement retired;
  std::optional<std::int64_t> path_id;
  {
    const auto query = database.cached(
        "SELECT task.name, attempt.path_id FROM attempt JOIN task ON task.id = attempt.task_id "
        "WHERE attempt.report_uuid = ?");
    if (!query->bind(1, Bytes(report_uuid.bytes)).step())
      return Error{ErrorCode::NotFound, "path " + report_uuid.text() + ": no such report"};
    retired.task = query->column_text(0);
    if (!query->column_is_null(1))
      path_id = query->column_integer(1);
  }
  if (!path_id)
    return Error{ErrorCode::InvalidInput,
                 "path " + report_uuid.text() + ": this report brought no path"};
  std::optional<PathRow> path;
  {
    const auto query = database.cached(std::string(kRetiredColumns) +
                                       "JOIN robot ON robot.id = path.robot_id "
                                       "WHERE path.id = ? AND retired_ms IS NULL");
    if (query->bind(1, *path_id).step())
      path = read_retired(*query);
  }
  if (path)
    retire(batch, *path, retired);
  return retired;
}

Result<TaskReset> begin_reset(Database& database, std::string_view task) {
  const auto query = database.cached(
      "SELECT id, (SELECT coalesce(max(id), 0) FROM path) FROM task WHERE name = ?");
  if (!query->bind(1, task).step())
    return Error{ErrorCode::NotFound, "task '" + std::string(task) + "': no such task"};
  return TaskReset{query->column_integer(0), query->column_integer(1)};
}

bool continue_reset(Batch& batch, const TaskReset& reset, Retirement& retired) {
  Database& database = batch.database();
  std::vector<PathRow> paths = select_rows(
      database, reset,
      "INDEXED BY path_by_task_robot CROSS JOIN robot ON robot.id = path.robot_id "
      "WHERE path.task_id = ?1 AND path.id <= ?2 AND damaged = 0 AND retired_ms IS NULL LIMIT ?3",
      kPathsOfAStep);
  if (paths.empty())
    paths = select_rows(database, reset,
                        "INDEXED BY path_damaged CROSS JOIN robot ON robot.id = path.robot_id "
                        "WHERE path.task_id = ?1 AND path.id <= ?2 AND damaged = 1 "
                        "AND retired_ms IS NULL LIMIT ?3",
                        kPathsOfAStep);
  for (const PathRow& path : paths)
    retire(batch, path, retired);
  return !paths.empty();
}

}  // namespace kinship::store
