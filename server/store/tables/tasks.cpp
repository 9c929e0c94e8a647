#include "server/store/tables/tasks.hpp"

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "server/store/tables/audit.hpp"
#include "server/store/tables/distributions.hpp"
#include "server/store/tables/experience.hpp"
#include "server/store/tables/pages.hpp"
#include "server/store/tables/rehearsals.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/robot_columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store {
namespace {

/// Not removed, or with attempts that came since.
constexpr std::string_view kIsListed =
    "(task.removed_attempts IS NULL OR task.removed_attempts < (SELECT coalesce(sum(attempts), 0)"
    " FROM experience WHERE experience.task_id = task.id))";

/// Deletes the distributions of a task. \return their ids.
std::vector<Digest> delete_distributions_of(Session& session, std::int64_t task_id) {
  lock_distributions(session);
  std::vector<Digest> ids;
  for (const Row& row :
       session.query("SELECT digest FROM distribution WHERE task_id = $1 AND NOT " +
                         session.is_quarantined("distribution"),
                     task_id))
    ids.push_back(id_of<Digest>(row.column_blob(0)));
  for (const Digest& id : ids)
    static_cast<void>(delete_distribution(session, id));
  return ids;
}

/// The robots of some tasks, without removed ones, by task.
/// \param which  a condition on table task.
std::map<std::int64_t, std::vector<TaskRobotSummary>> robots_of_tasks(
    Session& session, const std::string& which, std::span<const Parameter> parameters) {
  constexpr int kTask = 0, kRobot = 1;
  const std::map<std::int64_t, RobotName> names = select_robot_names(session);
  std::map<std::int64_t, std::vector<TaskRobotSummary>> robots;
  for (const Row& row :
       session.query_with("SELECT " + std::string(kTaskRobotColumns) + "FROM experience WHERE " +
                              session.is_intact("experience") +
                              " AND task_id IN (SELECT id FROM task WHERE " + which + ")",
                          parameters))
    if (const auto name = names.find(row.column_integer(kRobot));
        name != names.end() && !is_removed_label(name->second.label))
      robots[row.column_integer(kTask)].push_back(
          read_task_robot(row, name->second.digest, name->second.label));
  return robots;
}

Page<TaskSummary> read_tasks(Session& session, const std::string& which,
                             std::span<const Parameter> parameters, std::int64_t limit) {
  const std::string listed = is_listed_task(session) + " AND " + which;
  auto robots = robots_of_tasks(session, listed, parameters);
  return read_page<TaskSummary>(
      session.query_with("SELECT id, name FROM task WHERE " + listed, parameters), limit,
      [&](const Row& task) {
        return summary_of(task.column_text(1), std::move(robots[task.column_integer(0)]));
      },
      [](const Row& task) { return std::string(task.column_text(1)); });
}

}  // namespace

std::string is_listed_task(Session& session) {
  return session.is_intact("task") + " AND " + std::string(kIsListed);
}

std::int64_t ensure_task(Session& session, std::string_view task) {
  const std::string find = "SELECT id FROM task WHERE name = $1 AND " + session.is_intact("task");
  if (const std::optional<std::int64_t> id = session.find_integer(find, task))
    return *id;
  session.require_absent("task", "name", Parameter(task));
  session.query("INSERT INTO task (name) VALUES ($1) ON CONFLICT (name) DO NOTHING", task);
  if (const std::optional<std::int64_t> id = session.find_integer(find, task))
    return *id;
  throw Failure(ErrorCode::Storage, "task '" + std::string(task) + "': its row is damaged");
}

std::optional<std::int64_t> find_task(Session& session, std::string_view task) {
  std::string find = "SELECT id FROM task WHERE name = $1 AND " + std::string(kIsListed);
  const std::optional<std::int64_t> id =
      session.find_integer(find + " AND " + session.is_intact("task"), task);
  if (id)
    return id;
  session.require_absent("task", "name", Parameter(task));
  if (session.find_integer(find, task))
    throw Failure(ErrorCode::Storage, "task '" + std::string(task) + "': its row is damaged");
  return std::nullopt;
}

Page<TaskSummary> page_of_tasks(Session& session, std::string_view cursor, std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  return read_tasks(session, "name > $1 ORDER BY name LIMIT $2",
                    std::array{Parameter(cursor), Parameter(rows + 1)}, rows);
}

std::optional<TaskSummary> summary_of_task(Session& session, std::string_view task) {
  Page<TaskSummary> page = read_tasks(session, "name = $1", std::array{Parameter(task)}, 1);
  if (page.rows.empty())
    return std::nullopt;
  return std::move(page.rows.front());
}

std::vector<std::string> select_task_names(Session& session, const WantedNames& wanted) {
  std::string condition = is_listed_task(session);
  if (wanted.with_paths)
    condition += " AND EXISTS (SELECT 1 FROM experience WHERE task_id = task.id AND paths > 0)";
  std::vector<std::string> names;
  for (const Row& row : session.query(
           "SELECT name FROM task WHERE length(name) BETWEEN length(CAST($1 AS text)) - $2"
           " AND length(CAST($1 AS text)) + $2 AND " +
               condition + " ORDER BY name LIMIT $3",
           wanted.like, wanted.letters, wanted.limit))
    names.emplace_back(row.column_text(0));
  return names;
}

Result<std::vector<Digest>> rename_task(Session& session, std::string_view task,
                                        std::string_view name, const AuditEntry* audit) {
  // Waits for reports that name it, which lock its row and then its pairs.
  const std::optional<std::int64_t> id = session.find_integer(
      "SELECT id FROM task WHERE name = $1 AND " + std::string(kIsListed) + " AND " +
          session.is_intact("task") + std::string(session.dialect().for_update),
      task);
  if (!id)
    return Error{ErrorCode::NotFound, "no task '" + std::string(task) + "'"};
  if (session.find_integer("SELECT id FROM task WHERE name = $1", name))
    return Error{ErrorCode::Conflict,
                 "task '" + std::string(name) +
                     (find_task(session, name)
                          ? "' exists: two tasks cannot become one"
                          : "' was removed, and its attempts stay on record under that name")};
  lock_pairs_of_task(session, *id);
  std::vector<Digest> gone = delete_distributions_of(session, *id);
  for (const std::string_view either : {task, name})  // one of the new name is of a former task
    delete_rehearsals_of(session, either);
  session.query("UPDATE task SET name = $1 WHERE id = $2", name, *id);
  // What memories have of either name is of another task from now on.
  session.query(
      "UPDATE experience SET generation = generation + 1,"
      " retired_generation = generation + 1" +
          std::string(session.dialect().mark_changed) + " WHERE task_id = $1",
      *id);
  if (!session.dialect().note_former_task.empty())
    session.query(session.dialect().note_former_task, task);
  note_act(session, audit, AuditOutcome::Done, "'" + std::string(task) + "'",
           "'" + std::string(name) + "'");
  return gone;
}

std::uint64_t attempts_of_task(Session& session, std::int64_t task_id) {
  return static_cast<std::uint64_t>(
      session
          .find_integer("SELECT CAST(coalesce(sum(attempts), 0) AS bigint) FROM experience"
                        " WHERE task_id = $1",
                        task_id)
          .value_or(0));
}

RemovedTask end_task_removal(Session& session, std::int64_t task_id, TaskRemoval removal,
                             const AuditEntry* audit) {
  RemovedTask removed{std::move(removal), delete_distributions_of(session, task_id)};
  removed.removal.distributions = removed.distributions.size();
  session.query("UPDATE task SET removed_attempts = $1 WHERE id = $2", removed.removal.attempts,
                task_id);
  for (const Row& task : session.query("SELECT name FROM task WHERE id = $1", task_id))
    removed.removal.task = task.column_text(0);  // it may have been renamed meanwhile
  delete_rehearsals_of(session, removed.removal.task);
  note_act(session, audit, AuditOutcome::Done, {}, describe_removal(removed.removal));
  return removed;
}

}  // namespace kinship::store
