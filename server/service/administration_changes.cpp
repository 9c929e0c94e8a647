// The verbs by which administrators make changes.

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "server/service/administration.hpp"
#include "server/service/find_by_name.hpp"
#include "server/service/restore_paths.hpp"

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
  const Uuid report = report_of(parts_.store, uuid);
  try {
    return retired(parts_.store.retire_path(report, &call.audit), "path " + report.text());
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

AdminPage Administration::restore_path(const Call& call) {
  const AdminRequest& request = call.request;
  if (request.argument.empty() == (request.task.empty() && request.robot.empty()))
    return page_of(
        Error{ErrorCode::InvalidInput, "restore_path: takes a path's report, or a task or robot"});
  Restoration restored;
  restored.task = request.task;
  const std::vector<Uuid> reports = reports_to_restore(request);
  if (!request.argument.empty()) {
    const std::optional<Attempt> attempt = parts_.store.find_attempt(reports.front());
    if (!attempt)
      return page_of(not_found("report", request.argument));
    restored.task = attempt->task;
  }
  trail_.begin(call.audit, {});
  const auto tell = [&] {
    if (restored.paths == 0)
      return;
    if (!restored.task.empty())
      parts_.guidance.new_experience(restored.task);
    else
      for_each_task([&](const TaskSummary& task) { parts_.guidance.new_experience(task.task); });
    parts_.on_change(restored.task, std::to_string(restored.paths) + " paths restored");
  };
  try {
    restore_paths(parts_.store, reports, parts_.stop, restored);
  } catch (const Failure& failure) {
    tell();
    return failure.code() == ErrorCode::Unavailable ? page_of_unfinished(failure.error())
                                                    : page_of(failure.error());
  }
  tell();
  trail_.end(call.audit, {},
             std::to_string(restored.paths) + " paths restored, " +
                 std::to_string(restored.in_use + restored.lost) + " left out");
  return page_of(std::move(restored));
}

/// Of one path, or of the retired ones of a robot and task, each empty for all, in the order in
/// which they came. \throws Failure(NotFound)
std::vector<Uuid> Administration::reports_to_restore(const AdminRequest& request) const {
  if (!request.argument.empty())
    return {report_of(parts_.store, request.argument)};
  const std::optional<Digest> robot = robot_filter({.robot = request.robot});
  const std::string& task = request.task;
  std::vector<Uuid> retired;
  std::string cursor;
  do {
    const store::Page<PathSummary> page =
        parts_.store.list_paths(robot, task, cursor, kMaxPageRows);
    for (const PathSummary& path : page.rows)
      if (path.retired_ms != 0 && !path.dropped)
        retired.push_back(path.report_uuid);
    cursor = page.next_cursor;
  } while (!cursor.empty());
  // A removed task is not listed, and may be restored.
  if (retired.empty() && !task.empty() && !parts_.store.find_task(task))
    throw Failure(no_task(parts_.store, task));
  std::ranges::reverse(retired);
  retired.erase(std::unique(retired.begin(), retired.end()), retired.end());
  return retired;
}

AdminPage Administration::rename_task(const Call& call) {
  const std::string &task = call.request.task, &name = call.request.argument;
  if (const auto error = check_task(name))
    return page_of(*error);
  if (!parts_.store.find_task(task))
    return page_of(no_task(parts_.store, task));
  const std::vector<Digest> gone =
      parts_.store.rename_task(task, name, &call.audit).value_or_throw();
  drop_tasks({task, name}, gone);
  parts_.on_change(name, "task '" + task + "' is called '" + name + "' now");
  TaskSummary unread;  // another server may have renamed it on
  unread.task = name;
  return page_of(parts_.store.find_task(name).value_or(std::move(unread)));
}

AdminPage Administration::remove_task(const Call& call) {
  const std::string& task = call.request.argument;
  if (!parts_.store.find_task(task))
    return page_of(no_task(parts_.store, task));
  Result<store::RemovedTask> removed = Error{};
  try {
    removed = parts_.store.remove_task(task, parts_.stop, &call.audit);
  } catch (const std::exception&) {  // some of its paths may be retired
    parts_.guidance.forget_task(task);
    throw;
  }
  if (!removed) {
    parts_.guidance.forget_task(task);
    return removed.error().code == ErrorCode::Unavailable ? page_of_unfinished(removed.error())
                                                          : page_of(removed.error());
  }
  drop_tasks({task}, removed->distributions);
  parts_.on_change(task, "removed: " + std::to_string(removed->removal.paths) + " paths retired, " +
                             std::to_string(removed->removal.attempts) +
                             " attempts stay on record");
  return page_of(removed->removal);
}

void Administration::drop_tasks(std::initializer_list<std::string> tasks,
                                const std::vector<Digest>& distributions) {
  for (const Digest& distribution : distributions)
    parts_.guidance.forget_distribution(distribution);
  for (const std::string& task : tasks)
    parts_.guidance.drop_task(task);
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
  for_each_task([&](const TaskSummary& task) {
    if (std::ranges::any_of(task.robots, [&](const auto& row) { return row.robot == robot; }))
      parts_.guidance.forget_task(task.task);
  });
}

void Administration::for_each_task(const std::function<void(const TaskSummary&)>& take) const {
  std::string cursor;
  do {
    const store::Page<TaskSummary> page = parts_.store.list_tasks(cursor, kMaxPageRows);
    for (const TaskSummary& task : page.rows)
      take(task);
    cursor = page.next_cursor;
  } while (!cursor.empty());
}

}  // namespace kinship::service
