#include "server/store/sqlite/rows/robot_removal.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/sqlite/rows/retirement.hpp"
#include "server/store/tables/audit.hpp"
#include "server/store/tables/distributions.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/robot_columns.hpp"
#include "server/store/values/robot_rest.hpp"

namespace kinship::store {
namespace {

std::int64_t row_of(Database& database, const Digest& robot) {
  const auto query = database.cached("SELECT id FROM robot WHERE digest = ?");
  query->bind(1, Bytes(robot.bytes)).step();
  return query->column_integer(0);
}

/// From indexes and small rows.
RobotRest select_rest(Database& database, std::int64_t robot_id) {
  RobotRest rest;
  const auto tasks = database.cached(
      "SELECT task.name, experience.attempts FROM experience "
      "JOIN task ON task.id = experience.task_id WHERE robot_id = ?");
  tasks->bind(1, robot_id);
  while (tasks->step()) {
    rest.tasks.emplace(tasks->column_text(0));
    rest.attempts += count_of(*tasks, 1);
  }
  const auto distributions = database.cached(
      "SELECT distribution.digest, task.name FROM distribution "
      "JOIN task ON task.id = distribution.task_id WHERE robot_id = ? AND NOT EXISTS "
      "(SELECT 1 FROM set_aside WHERE kind = 4 AND set_aside.id = distribution.id)");
  distributions->bind(1, robot_id);
  while (distributions->step()) {
    rest.distributions.push_back(id_of<Digest>(distributions->column_blob(0)));
    rest.tasks.emplace(distributions->column_text(1));
  }
  return rest;
}

/// Attempts, or distributions whose damaged rows cannot be deleted.
bool is_referred_to(Database& database, std::int64_t robot_id) {
  const auto query = database.cached(
      "SELECT EXISTS (SELECT 1 FROM experience WHERE robot_id = ?1) OR"
      " EXISTS (SELECT 1 FROM distribution WHERE robot_id = ?1)");
  query->bind(1, robot_id).step();
  return query->column_integer(0) != 0;
}

/// \return whether none is left.
bool retire_step(Batch& batch, const Digest& robot, RemovedRobot& removed) {
  std::int64_t left = kPathsOfAStep;
  for (const ExperienceKey& key : select_experience(batch.database(), robot, "")) {
    Retirement retired;
    left -= retire_some(batch, key, left, retired);
    removed.removal.paths += retired.paths;
    if (left <= 0)
      return false;
  }
  return true;
}

}  // namespace

Result<bool> continue_removal(Batch& batch, const Digest& robot, RemovedRobot& removed,
                              const AuditEntry* audit) {
  Database& database = batch.database();
  const std::optional<RobotRecord> record = select_robot(database, robot);
  if (!record)
    return Error{ErrorCode::NotFound, "robot " + robot.short_hex() + " is not registered"};
  const bool is_first = removed.removal.paths == 0;
  const std::string before = audit == nullptr ? "" : describe_robot(database, robot);
  if (!retire_step(batch, robot, removed)) {
    if (is_first)
      note_act(database, audit, AuditOutcome::Begun, before);
    return false;
  }
  const std::int64_t id = row_of(database, robot);
  RobotRest rest = select_rest(database, id);
  for (const Digest& distribution : rest.distributions)
    static_cast<void>(delete_distribution(database, distribution));
  const bool is_deleted = !is_referred_to(database, id);
  if (is_deleted)
    delete_robot(database, id);
  else if (const auto relabelled = relabel_robot(database, robot, removed_label(robot));
           !relabelled)
    return relabelled.error();
  complete_removal(removed, *record, std::move(rest), is_deleted);
  note_act(database, audit, AuditOutcome::Done, before, describe_removal(removed.removal));
  return true;
}

}  // namespace kinship::store
