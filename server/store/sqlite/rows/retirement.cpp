#include "server/store/sqlite/rows/retirement.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/rows/attempt_rows.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/retired_reports.hpp"
#include "server/store/sqlite/rows/set_aside_rows.hpp"
#include "server/store/tables/audit.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store {
namespace {

// Of the paths: what is not retired, also if it is damaged.
constexpr std::string_view kNotRetired =
    " AND retired_ms IS NULL AND NOT EXISTS (SELECT 1 FROM set_aside WHERE kind = 1 AND"
    " set_aside.id = path.id AND set_aside.retired_ms IS NOT NULL) ";

struct PathRow {
  std::int64_t id = 0;
  ExperienceKey key;
  Digest robot;
};

/// \return false if the row cannot be read, so that it cannot be written either.
bool mark_retired(Database& database, std::int64_t id) {
  try {
    Savepoint savepoint(database);
    database.cached("UPDATE path SET retired_ms = ? WHERE id = ?")->bind_all(now_ms(), id).run();
    savepoint.keep();
    return true;
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    return false;
  }
}

/// A damaged path was in fits before it was found damaged: it is retired as any other, but was
/// taken out of the count already.
void retire(Batch& batch, const PathRow& path, Retirement& retired) {
  Database& database = batch.database();
  note_retired_path(database, path.key, path.id);
  const bool aside = find_aside(database, AsideKind::Path, path.id).has_value();
  if (aside)
    retire_aside(database, path.id);
  else if (mark_retired(database, path.id))
    uncount_paths(database, path.key, 1);
  else
    retire_damaged(batch, path.key, path.id);
  batch.paths_retired(path.key.task_id, path.key.robot_id);
  ++retired.paths;
  const auto place = std::ranges::lower_bound(retired.robots, path.robot);
  if (place == retired.robots.end() || *place != path.robot)
    retired.robots.insert(place, path.robot);
}

Digest digest_of_robot(Database& database, std::int64_t robot_id) {
  const auto query = database.cached("SELECT digest FROM robot WHERE id = ?");
  return query->bind(1, robot_id).step() ? id_of<Digest>(query->column_blob(0)) : Digest();
}

/// The next paths of a task that are not retired, from indexes alone.
std::vector<PathRow> select_rows(Database& database, const TaskReset& reset) {
  std::vector<PathRow> rows;
  {
    const auto query = database.cached(
        "SELECT id, task_id, robot_id FROM path INDEXED BY path_by_task_robot "
        "WHERE task_id = ?1 AND id <= ?2" +
        std::string(kNotRetired) + "LIMIT ?3");
    query->bind_all(reset.task_id, reset.last_path_id, kPathsOfAStep);
    while (query->step())
      rows.push_back(
          {query->column_integer(0), {query->column_integer(1), query->column_integer(2)}, {}});
  }
  std::map<std::int64_t, Digest> robots;
  for (PathRow& row : rows) {
    const auto [robot, is_new] = robots.try_emplace(row.key.robot_id);
    if (is_new)
      robot->second = digest_of_robot(database, row.key.robot_id);
    row.robot = robot->second;
  }
  return rows;
}

}  // namespace

Result<Retirement> retire_path(Batch& batch, const Uuid& report_uuid, const AuditEntry* audit) {
  Database& database = batch.database();
  const ReportRows report = find_report(database, report_uuid);
  if (!report.row && report.damaged.empty())
    return Error{ErrorCode::NotFound, "path " + report_uuid.text() + ": no such report"};
  if (!report.row)
    return Error{ErrorCode::Storage, "path " + report_uuid.text() + ": its attempt is damaged"};
  AttemptRow attempt = select_attempt(database, *report.row);
  name_robot_and_task(database, attempt);
  if (!attempt.path_id)
    return Error{ErrorCode::InvalidInput,
                 "path " + report_uuid.text() +
                     (attempt.attempt.record.outcome == Outcome::Solved
                          ? ": it was not kept, there were as many as may be"
                          : ": this report brought no path")};
  Retirement retired;
  retired.task = attempt.attempt.task;
  const std::int64_t before = audit == nullptr ? 0 : count_paths_of(database, retired.task);
  const ExperienceKey key{attempt.task_id, attempt.robot_id};
  const std::int64_t id =
      row_in_use(database, AsideKind::Path, *attempt.path_id).value_or(*attempt.path_id);
  const std::optional<Aside> aside = find_aside(database, AsideKind::Path, id);
  if (!(aside && aside->retired) && !is_retired(database, key, id))
    retire(batch, {id, key, attempt.attempt.robot}, retired);
  note_retired_report(database, report_uuid);
  if (audit != nullptr)
    note_act(database, audit, AuditOutcome::Done, describe_paths(retired.task, before),
             in_number(count_paths_of(database, retired.task), "path"));
  return retired;
}

std::vector<Retirement> retire_reports(Batch& batch, std::span<const Uuid> reports) {
  std::map<std::string, Retirement> retired;  // by task
  for (const Uuid& report : reports) {
    if (!note_retired_report(batch.database(), report))
      continue;
    // What is not here, has no path or cannot be read is remembered by its UUID alone.
    const Result<Retirement> one = retire_path(batch, report, nullptr);
    if (!one || one->paths == 0)
      continue;
    Retirement& of_task = retired[one->task];
    of_task.task = one->task;
    of_task.paths += one->paths;
    for (const Digest& robot : one->robots)
      if (!std::ranges::binary_search(of_task.robots, robot))
        of_task.robots.insert(std::ranges::lower_bound(of_task.robots, robot), robot);
  }
  std::vector<Retirement> by_task;
  for (auto& [task, retirement] : retired)
    by_task.push_back(std::move(retirement));
  return by_task;
}

Result<TaskReset> begin_reset(Database& database, std::string_view task, const AuditEntry* audit) {
  const auto query = database.cached(
      "SELECT id, (SELECT coalesce(max(id), 0) FROM path) FROM task WHERE name = ?");
  if (!query->bind(1, task).step())
    return Error{ErrorCode::NotFound, "task '" + std::string(task) + "': no such task"};
  if (audit != nullptr)
    note_act(database, audit, AuditOutcome::Begun,
             describe_paths(task, count_paths_of(database, task)));
  return TaskReset{query->column_integer(0), query->column_integer(1)};
}

bool continue_reset(Batch& batch, const TaskReset& reset, Retirement& retired,
                    const AuditEntry* audit) {
  Database& database = batch.database();
  const std::vector<PathRow> paths = select_rows(database, reset);
  for (const PathRow& path : paths)
    retire(batch, path, retired);
  if (paths.empty() && audit != nullptr)
    note_act(database, audit, AuditOutcome::Done, {},
             describe_paths(retired.task, count_paths_of(database, retired.task)) + ", " +
                 std::to_string(retired.paths) + " retired");
  return !paths.empty();
}

std::int64_t retire_some(Batch& batch, const ExperienceKey& key, std::int64_t limit,
                         Retirement& retired) {
  Database& database = batch.database();
  const Digest robot = digest_of_robot(database, key.robot_id);
  std::vector<PathRow> paths;
  {
    const auto query = database.cached(
        "SELECT id FROM path INDEXED BY path_by_task_robot WHERE task_id = ? AND robot_id = ?" +
        std::string(kNotRetired) + "LIMIT ?");
    query->bind_all(key.task_id, key.robot_id, limit);
    while (query->step())
      paths.push_back({query->column_integer(0), key, robot});
  }
  for (const PathRow& path : paths)
    retire(batch, path, retired);
  return std::ssize(paths);
}

}  // namespace kinship::store
