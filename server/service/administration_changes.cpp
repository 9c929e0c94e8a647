// The verbs by which administrators make changes.

#include <algorithm>
#include <optional>
#include <utility>

#include "server/service/administration.hpp"
#include "server/service/find_by_name.hpp"

namespace kinship::service {
namespace {

std::string describe(const RobotRemoval& removal) {
  const std::string what = "robot '" + removal.label + "' (" + removal.robot.short_hex() + ") ";
  const std::string distributions = std::to_string(removal.distributions) + " distributions";
  if (removal.is_deleted)
    return what + "deleted, it had no attempts; " + distributions + " of it are gone";
  return what + "removed: " + std::to_string(removal.paths) + " paths retired, " +
         std::to_string(removal.attempts) + " attempts stay on record, " + distributions +
         " are gone";
}

/// Of a verb that can be requested again: a part of it may be done until then.
AdminPage page_of_unfinished(const Error& error) {
  AdminPage page = page_of(error);
  page.status = AdminStatus::Failed;
  return page;
}

}  // namespace

AdminPage Administration::evict_distribution(const Call& call) {
  const std::string& prefix = call.request.argument;
  const Digest id = find_distribution_id(parts_.store, prefix).value_or_throw();
  const bool was_there = parts_.store.evict_distribution(id, &call.audit);
  // One that could not be stored is in memory only.
  parts_.guidance.forget_distribution(id);
  if (!was_there)
    return page_of(not_found("distribution", prefix));
  parts_.on_change({}, "distribution " + id.short_hex() + " evicted");
  return page_of(Eviction{id});
}

AdminPage Administration::retire_path(const Call& call) {
  const std::string& uuid = call.request.argument;
  const Uuid report = report_of(uuid);
  try {
    return retired(parts_.store.retire_path(report, &call.audit), "path " + uuid);
  } catch (const std::exception&) {  // it may be retired all the same
    if (const std::optional<Attempt> attempt = parts_.store.find_attempt(report))
      parts_.guidance.forget_task(attempt->task);
    throw;
  }
}

AdminPage Administration::reset_task(const Call& call) {
  const std::string& task = call.request.argument;
  Result<Retirement> retirement = Error{};
  try {
    retirement = parts_.store.reset_task(task, parts_.stop, &call.audit);
  } catch (const std::exception&) {  // some of its paths may be retired
    parts_.guidance.forget_task(task);
    throw;
  }
  if (!retirement && retirement.error().code == ErrorCode::Unavailable) {
    parts_.guidance.forget_task(task);
    return page_of_unfinished(retirement.error());
  }
  return retired(std::move(retirement), "reset");
}

AdminPage Administration::retired(Result<Retirement> retirement, const std::string& what) {
  if (!retirement)
    return page_of(retirement.error());
  parts_.guidance.forget_task(retirement->task);
  parts_.on_change(retirement->task,
                   what + ": " + std::to_string(retirement->paths) + " paths retired");
  return page_of(std::move(retirement).value());
}

AdminPage Administration::rename_robot(const Call& call) {
  RobotSummary robot = find_robot(parts_.store, call.request.robot).value_or_throw();
  const std::string before = std::exchange(robot.label, call.request.argument);
  static_cast<void>(
      parts_.robots.rename_robot(robot.robot, robot.label, &call.audit).value_or_throw());
  name_solver(robot);
  if (before != robot.label)
    parts_.on_change({}, "robot '" + before + "' (" + robot.robot.short_hex() + ") is called '" +
                             robot.label + "' now");
  return page_of(std::move(robot));
}

AdminPage Administration::remove_robot(const Call& call) {
  const RobotSummary robot = find_robot(parts_.store, call.request.argument).value_or_throw();
  Result<store::RemovedRobot> removed = Error{};
  try {
    removed = parts_.robots.remove_robot(robot.robot, parts_.stop, &call.audit);
  } catch (const std::exception&) {  // some of its paths may be retired
    forget_tasks_of(robot.robot);
    throw;
  }
  if (!removed) {
    forget_tasks_of(robot.robot);
    return removed.error().code == ErrorCode::Unavailable ? page_of_unfinished(removed.error())
                                                          : page_of(removed.error());
  }
  for (const Digest& distribution : removed->distributions)
    parts_.guidance.forget_distribution(distribution);
  parts_.guidance.forget_robot(robot.robot);
  for (const std::string& task : removed->tasks)
    parts_.guidance.forget_task(task);
  parts_.on_change({}, describe(removed->removal));
  return page_of(removed->removal);
}

/// Of a robot that was not removed as a whole.
void Administration::forget_tasks_of(const Digest& robot) {
  parts_.guidance.forget_robot(robot);
  std::string cursor;
  do {
    const store::Page<TaskSummary> page = parts_.store.list_tasks(cursor, kMaxPageRows);
    for (const TaskSummary& task : page.rows)
      if (std::ranges::any_of(task.robots, [&](const auto& row) { return row.robot == robot; }))
        parts_.guidance.forget_task(task.task);
    cursor = page.next_cursor;
  } while (!cursor.empty());
}

}  // namespace kinship::service
