#include "server/store/tables/retirement.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "server/store/tables/audit.hpp"
#include "server/store/tables/distributions.hpp"
#include "server/store/tables/experience.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/tables/searches.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/robot_columns.hpp"

namespace kinship::store {
namespace {

/// The most paths that are retired in one transaction: each is written anew.
constexpr std::int64_t kPathsOfAStep = 500;

/// Retires paths of these robots and tasks, kPathsOfAStep at most. \return how many.
std::int64_t retire_step(const std::vector<ExperienceKey>& keys, std::int64_t last_id,
                         const RetireSome& retire_some) {
  std::int64_t left = kPathsOfAStep;
  for (const ExperienceKey& key : keys)
    if (left > 0)
      left -= retire_some(key, left, last_id);
  return kPathsOfAStep - left;
}

Digest digest_of_robot(Session& session, std::int64_t robot_id) {
  const Rows rows = session.query(
      "SELECT digest FROM robot WHERE id = $1 AND " + session.is_intact("robot"), robot_id);
  return rows.empty() ? Digest() : id_of<Digest>(rows.front().column_blob(0));
}

/// Counts a robot's rows beside its paths, from indexes and small rows.
void count_rest(Session& session, std::int64_t robot_id, RemovedRobot& removed) {
  std::set<std::string> tasks;  // of its attempts and distributions
  for (const Row& row : session.query("SELECT task.name, attempts FROM experience"
                                      " JOIN task ON task.id = task_id WHERE robot_id = $1",
                                      robot_id)) {
    tasks.emplace(row.column_text(0));
    removed.removal.attempts += count_of(row, 1);
  }
  for (const Row& row :
       session.query("SELECT digest, task.name FROM distribution"
                     " JOIN task ON task.id = task_id WHERE robot_id = $1 AND NOT " +
                         session.is_quarantined("distribution"),
                     robot_id)) {
    removed.distributions.push_back(id_of<Digest>(row.column_blob(0)));
    tasks.emplace(row.column_text(1));
  }
  removed.tasks.assign(tasks.begin(), tasks.end());
  removed.removal.distributions = removed.distributions.size();
}

Error stopped_after(std::uint64_t paths, const std::string& what) {
  return {ErrorCode::Unavailable, what + ": the server is stopping after " + std::to_string(paths) +
                                      " paths were retired; ask again for the rest"};
}

/// Attempts, or distributions whose damaged rows cannot be deleted.
bool is_referred_to(Session& session, std::int64_t robot_id) {
  return session.find_integer(
             "SELECT EXISTS (SELECT 1 FROM experience WHERE robot_id = $1) OR"
             " EXISTS (SELECT 1 FROM distribution WHERE robot_id = $1)",
             robot_id) != 0;
}

}  // namespace

Result<TaskReset> begin_reset(Session& session, std::string_view task, const AuditEntry* audit) {
  const Rows rows = session.query(
      "SELECT id, (SELECT coalesce(max(id), 0) FROM path) FROM task WHERE name = $1", task);
  if (rows.empty())
    return Error{ErrorCode::NotFound, "task '" + std::string(task) + "': no such task"};
  if (audit != nullptr)
    note_act(session, audit, AuditOutcome::Begun,
             describe_paths(task, count_paths_of(session, task)));
  return TaskReset{rows.front().column_integer(0), rows.front().column_integer(1)};
}

Step<Retirement> continue_reset(Session& session, const TaskReset& reset, Retirement retired,
                                const RetireSome& retire_some, const AuditEntry* audit) {
  const auto retire_and_name = [&](const ExperienceKey& key, std::int64_t limit,
                                   std::int64_t last_id) {
    const std::int64_t gone = retire_some(key, limit, last_id);
    if (gone > 0)
      add_robot(retired, digest_of_robot(session, key.robot_id));
    return gone;
  };
  const std::int64_t gone =
      retire_step(lock_pairs_of_task(session, reset.task_id), reset.last_path_id, retire_and_name);
  retired.paths += static_cast<std::uint64_t>(gone);
  if (gone == 0)
    for (const ExperienceKey& key : lock_pairs_of_task(session, reset.task_id))
      drop_searches_of(session, key);
  if (gone == 0 && audit != nullptr)
    note_act(session, audit, AuditOutcome::Done, {},
             describe_paths(retired.task, count_paths_of(session, retired.task)) + ", " +
                 std::to_string(retired.paths) + " retired");
  return {std::move(retired), gone == 0};
}

Result<Step<RemovedRobot>> continue_removal(Session& session, const Digest& robot,
                                            RemovedRobot removed, const RetireSome& retire_some,
                                            const AuditEntry* audit) {
  const std::optional<std::int64_t> id = lock_robot(session, robot);
  const std::optional<RobotRecord> record = id ? select_robot(session, robot) : std::nullopt;
  if (!record)
    return Error{ErrorCode::NotFound, "robot " + robot.short_hex() + " is not registered"};
  const bool is_first = removed.removal.paths == 0;
  const std::string before = audit == nullptr ? "" : describe_robot(session, robot);
  const std::int64_t gone = retire_step(lock_pairs_of_robot(session, *id),
                                        std::numeric_limits<std::int64_t>::max(), retire_some);
  removed.removal.paths += static_cast<std::uint64_t>(gone);
  if (gone == kPathsOfAStep) {
    if (is_first)
      note_act(session, audit, AuditOutcome::Begun, before);
    return Step<RemovedRobot>{std::move(removed), false};
  }
  lock_distributions(session);
  count_rest(session, *id, removed);
  for (const Digest& distribution : removed.distributions)
    static_cast<void>(delete_distribution(session, distribution));
  for (const ExperienceKey& key : lock_pairs_of_robot(session, *id))
    drop_searches_of(session, key);
  removed.removal.robot = robot;
  removed.removal.label = record->description.label;
  removed.removal.is_deleted = !is_referred_to(session, *id);
  if (removed.removal.is_deleted)
    delete_robot(session, *id);
  else if (const auto relabelled = relabel_robot(session, robot, removed_label(robot)); !relabelled)
    return relabelled.error();
  drop_unnamed_meshes(session);
  note_act(session, audit, AuditOutcome::Done, before, describe_removal(removed.removal));
  return Step<RemovedRobot>{std::move(removed), true};
}

Result<Retirement> reset_in_steps(std::string_view task, const std::stop_token& stop,
                                  const std::function<Step<Retirement>(const Retirement&)>& step) {
  Step<Retirement> last;
  last.counted.task = task;
  while (true) {
    last = step(last.counted);
    if (last.is_last)
      return std::move(last.counted);
    if (stop.stop_requested())
      return stopped_after(last.counted.paths, "task '" + last.counted.task + "'");
  }
}

Result<RemovedRobot> remove_in_steps(
    const Digest& robot, const std::stop_token& stop,
    const std::function<Result<Step<RemovedRobot>>(const RemovedRobot&)>& step) {
  RemovedRobot removed;
  while (true) {
    Result<Step<RemovedRobot>> next = step(removed);
    if (!next)
      return next.error();
    Step<RemovedRobot> done = std::move(next).value();
    removed = std::move(done.counted);
    if (done.is_last)
      return removed;
    if (stop.stop_requested())
      return stopped_after(removed.removal.paths, "robot " + robot.short_hex());
  }
}

void add_robot(Retirement& retired, const Digest& robot) {
  const auto place = std::ranges::lower_bound(retired.robots, robot);
  if (place == retired.robots.end() || *place != robot)
    retired.robots.insert(place, robot);
}

Error no_such_report(const Uuid& report) {
  return {ErrorCode::NotFound, "path " + report.text() + ": no such report"};
}

Error report_without_path(const Uuid& report, bool is_solved) {
  return {ErrorCode::InvalidInput,
          "path " + report.text() +
              (is_solved ? ": it was not kept, there were as many as may be"
                         : ": this report brought no path")};
}

}  // namespace kinship::store
