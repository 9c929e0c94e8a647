#include "server/store/postgres/rows/robot_removal.hpp"

#include <limits>
#include <string>
#include <utility>

#include "server/store/postgres/rows/experience_rows.hpp"
#include "server/store/postgres/rows/retirement.hpp"
#include "server/store/tables/audit.hpp"
#include "server/store/tables/distributions.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/robot_columns.hpp"
#include "server/store/values/robot_rest.hpp"

namespace kinship::store::postgres {
namespace {

RobotRest select_rest(Connection& connection, std::int64_t robot_id) {
  RobotRest rest;
  for (const Row row : connection.query("SELECT task.name, attempts FROM experience"
                                        " JOIN task ON task.id = task_id WHERE robot_id = $1",
                                        robot_id)) {
    rest.tasks.emplace(row.column_text(0));
    rest.attempts += count_of(row, 1);
  }
  for (const Row row : connection.query("SELECT digest, task.name FROM distribution"
                                        " JOIN task ON task.id = task_id WHERE robot_id = $1",
                                        robot_id)) {
    rest.distributions.push_back(id_of<Digest>(row.column_blob(0)));
    rest.tasks.emplace(row.column_text(1));
  }
  return rest;
}

/// \return whether none is left.
bool retire_step(Connection& connection, std::int64_t robot_id, RemovedRobot& removed) {
  std::int64_t left = kPathsOfAStep;
  for (const ExperienceKey& key : lock_pairs_of_robot(connection, robot_id)) {
    const std::int64_t gone =
        retire_some(connection, key, std::numeric_limits<std::int64_t>::max(), left);
    removed.removal.paths += static_cast<std::uint64_t>(gone);
    left -= gone;
    if (left <= 0)
      return false;
  }
  return true;
}

bool has_pairs(Connection& connection, std::int64_t robot_id) {
  return !connection.query("SELECT 1 FROM experience WHERE robot_id = $1 LIMIT 1", robot_id)
              .empty();
}

}  // namespace

Result<bool> continue_removal(Connection& connection, const Digest& robot, RemovedRobot& removed,
                              const AuditEntry* audit) {
  const std::optional<std::int64_t> id = lock_robot(connection, robot);
  const std::optional<RobotRecord> record = id ? select_robot(connection, robot) : std::nullopt;
  if (!record)
    return Error{ErrorCode::NotFound, "robot " + robot.short_hex() + " is not registered"};
  const bool is_first = removed.removal.paths == 0;
  const std::string before = audit == nullptr ? "" : describe_robot(connection, robot);
  if (!retire_step(connection, *id, removed)) {
    if (is_first)
      note_act(connection, audit, AuditOutcome::Begun, before);
    return false;
  }
  lock_distributions(connection);
  RobotRest rest = select_rest(connection, *id);
  for (const Digest& distribution : rest.distributions)
    static_cast<void>(delete_distribution(connection, distribution));
  const bool is_deleted = !has_pairs(connection, *id);
  if (is_deleted)
    delete_robot(connection, *id);
  else if (const auto relabelled = relabel_robot(connection, robot, removed_label(robot));
           !relabelled)
    return relabelled.error();
  complete_removal(removed, *record, std::move(rest), is_deleted);
  note_act(connection, audit, AuditOutcome::Done, before, describe_removal(removed.removal));
  return true;
}

}  // namespace kinship::store::postgres
