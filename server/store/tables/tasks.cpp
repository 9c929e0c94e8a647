#include "server/store/tables/tasks.hpp"

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "server/store/tables/audit.hpp"
#include "server/store/tables/distributions.hpp"
#include "server/store/tables/pages.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/tables/settings.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/robot_columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store {
namespace {

/// The setting of a removed task: the attempts that it had then. Later ones bring it back.
constexpr std::string_view kRemovedTask = "removed_task:";
constexpr std::string_view kNotRemoved =
    "NOT EXISTS (SELECT 1 FROM setting WHERE setting.key = 'removed_task:' || task.name"
    " AND setting.value = CAST((SELECT coalesce(sum(attempts), 0) FROM experience"
    " WHERE experience.task_id = task.id) AS text))";

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

Error no_such_task(std::string_view task) {
  return {ErrorCode::NotFound, "no task '" + std::string(task) + "'"};
}

/// The robots of some tasks, without removed ones, by task.
/// \param which  a condition on table task.
std::map<std::int64_t, std::vector<TaskRobotSummary>> robots_of_tasks(
    Session& session, const std::string& which, std::span<const Parameter> parameters) {
  constexpr int kRobot = 0, kTask = 11;
  const std::map<std::int64_t, RobotName> names = select_robot_names(session);
  std::map<std::int64_t, std::vector<TaskRobotSummary>> robots;
  for (const Row& row :
       session.query_with("SELECT " + std::string(kTaskRobotColumns) +
                              ", task_id FROM experience WHERE " + session.is_intact("experience") +
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
  const std::string intact =
      session.is_intact("task") + " AND " + std::string(kNotRemoved) + " AND " + which;
  auto robots = robots_of_tasks(session, intact, parameters);
  return read_page<TaskSummary>(
      session.query_with("SELECT id, name FROM task WHERE " + intact, parameters), limit,
      [&](const Row& task) {
        return summary_of(task.column_text(1), std::move(robots[task.column_integer(0)]));
      },
      [](const Row& task) { return std::string(task.column_text(1)); });
}

}  // namespace

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

Result<std::vector<Digest>> rename_task(Session& session, std::string_view task,
                                        std::string_view name, const AuditEntry* audit) {
  const std::string find = "SELECT id FROM task WHERE name = $1 AND " + session.is_intact("task");
  const std::optional<std::int64_t> id = session.find_integer(find, task);
  if (!id || !summary_of_task(session, task))
    return no_such_task(task);
  if (session.find_integer("SELECT id FROM task WHERE name = $1", name))
    return Error{ErrorCode::Conflict,
                 "task '" + std::string(name) +
                     (summary_of_task(session, name)
                          ? "' exists: two tasks cannot become one"
                          : "' was removed, and its attempts stay on record under that name")};
  std::vector<Digest> gone = delete_distributions_of(session, *id);
  session.query("UPDATE task SET name = $1 WHERE id = $2", name, *id);
  // A report that is known, sent again under the old name, makes a task without attempts.
  write_setting(session, std::string(kRemovedTask) + std::string(task), "0");
  write_setting(session, std::string(kRemovedTask) + std::string(name), std::nullopt);
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
  write_setting(session, std::string(kRemovedTask) + removed.removal.task,
                std::to_string(removed.removal.attempts));
  note_act(session, audit, AuditOutcome::Done, {}, describe_removal(removed.removal));
  return removed;
}

}  // namespace kinship::store
