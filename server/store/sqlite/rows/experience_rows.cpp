#include "server/store/sqlite/rows/experience_rows.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/recent_attempts.hpp"

namespace kinship::store {
namespace {

/// One by one, without those that cannot be read.
std::vector<KnownAttempt> readable_recent_of(Database& database, const ExperienceKey& key,
                                             std::int64_t max_rows) {
  const auto ids = database.cached(
      "SELECT id FROM attempt INDEXED BY attempt_by_task_robot "
      "WHERE task_id = ? AND robot_id = ? ORDER BY id DESC LIMIT ?");
  ids->bind_all(key.task_id, key.robot_id, max_rows);
  RecentAttempts recent;
  while (!recent.complete() && ids->step()) {
    const auto query = database.cached("SELECT " + std::string(RecentAttempts::kColumns) +
                                       "FROM attempt WHERE id = ?");
    try {
      if (query->bind(1, ids->column_integer(0)).step())
        recent.add(*query);
    } catch (const SqliteError& error) {
      if (!error.is_damage())
        throw;
    }
  }
  return recent.oldest_first();
}

/// The newest judged attempts in each sampling mode, oldest first. Looks at the newest
/// kMaxRecentRows alone.
std::vector<KnownAttempt> recent_of(Database& database, const ExperienceKey& key) {
  try {
    const auto query =
        database.cached("SELECT " + std::string(RecentAttempts::kColumns) +
                        "FROM attempt WHERE task_id = ? AND robot_id = ? ORDER BY id DESC LIMIT ?");
    query->bind_all(key.task_id, key.robot_id, kMaxRecentRows);
    RecentAttempts recent;
    while (!recent.complete() && query->step())
      recent.add(*query);
    return recent.oldest_first();
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    return readable_recent_of(database, key, kMaxRecentRows);
  }
}

}  // namespace

const RobotNames::Name* RobotNames::find(std::int64_t robot_id) {
  if (!names_.contains(robot_id) && !has_all_)
    try {
      const auto query = database_->cached("SELECT digest, label FROM robot WHERE id = ?");
      if (query->bind(1, robot_id).step())
        names_[robot_id] = {id_of<Digest>(query->column_blob(0)),
                            std::string(query->column_text(1))};
    } catch (const SqliteError& error) {
      if (!error.is_damage())
        throw;
      read_all();
    }
  const auto found = names_.find(robot_id);
  return found == names_.end() ? nullptr : &found->second;
}

void RobotNames::read_all() {
  has_all_ = true;
  const auto digests = database_->cached("SELECT id, digest FROM robot ORDER BY digest");
  while (digests->step())
    names_[digests->column_integer(0)].digest = id_of<Digest>(digests->column_blob(1));
  const auto labels = database_->cached("SELECT id, label FROM robot ORDER BY label");
  while (labels->step())
    names_[labels->column_integer(0)].label = labels->column_text(1);
}

std::uint64_t ensure_experience(Database& database, const ExperienceKey& key) {
  {
    const auto query =
        database.cached("SELECT paths FROM experience WHERE task_id = ? AND robot_id = ?");
    if (query->bind_all(key.task_id, key.robot_id).step())
      return count_of(*query, 0);
  }
  database.cached("INSERT INTO experience (task_id, robot_id) VALUES (?, ?)")
      ->bind_all(key.task_id, key.robot_id)
      .run();
  return 0;
}

void add_to_experience(Database& database, const ExperienceKey& key, const PairChange& change) {
  const auto integer = [](std::uint64_t count) { return static_cast<std::int64_t>(count); };
  const ModeTotals& guided = change.guided;
  const ModeTotals& control = change.control;
  database
      .cached(
          "UPDATE experience SET attempts = attempts + ?3, paths = paths + ?4,"
          " dropped = dropped + ?5, guided_attempts = guided_attempts + ?6,"
          " guided_solved = guided_solved + ?7, guided_checks = guided_checks + ?8,"
          " guided_checks_squared = guided_checks_squared + ?9,"
          " guided_checks_of_solved = guided_checks_of_solved + ?10,"
          " control_attempts = control_attempts + ?11, control_solved = control_solved + ?12,"
          " control_checks = control_checks + ?13,"
          " control_checks_squared = control_checks_squared + ?14,"
          " control_checks_of_solved = control_checks_of_solved + ?15"
          " WHERE task_id = ?1 AND robot_id = ?2")
      ->bind_all(key.task_id, key.robot_id, change.attempts, change.paths, change.dropped,
                 integer(guided.attempts), integer(guided.solved), guided.checks,
                 guided.checks_squared, guided.checks_of_solved, integer(control.attempts),
                 integer(control.solved), control.checks, control.checks_squared,
                 control.checks_of_solved)
      .run();
}

void uncount_paths(Database& database, const ExperienceKey& key, std::int64_t paths) {
  database.cached("UPDATE experience SET paths = paths - ? WHERE task_id = ? AND robot_id = ?")
      ->bind_all(paths, key.task_id, key.robot_id)
      .run();
}

std::optional<ExperienceKey> find_experience(Database& database, const Digest& robot,
                                             std::string_view task) {
  const auto query = database.cached(
      "SELECT experience.task_id, experience.robot_id FROM experience "
      "JOIN task ON task.id = experience.task_id JOIN robot ON robot.id = experience.robot_id "
      "WHERE task.name = ? AND robot.digest = ?");
  if (!query->bind_all(task, Bytes(robot.bytes)).step())
    return std::nullopt;
  return ExperienceKey{query->column_integer(0), query->column_integer(1)};
}

std::vector<ExperienceKey> select_experience(Database& database, const std::optional<Digest>& robot,
                                             std::string_view task, const ExperienceKey& first) {
  std::string sql = "SELECT task_id, robot_id FROM experience WHERE (task_id, robot_id) >= (?, ?)";
  if (!task.empty())
    sql += " AND task_id = (SELECT id FROM task WHERE name = ?3)";
  if (robot)
    sql += " AND robot_id = (SELECT id FROM robot WHERE digest = ?4)";
  const auto query = database.cached(sql + " ORDER BY task_id, robot_id");
  query->bind_all(first.task_id, first.robot_id);
  if (!task.empty())
    query->bind(3, task);
  if (robot)
    query->bind(4, Bytes(robot->bytes));
  std::vector<ExperienceKey> keys;
  while (query->step())
    keys.push_back({query->column_integer(0), query->column_integer(1)});
  return keys;
}

std::uint64_t generation_of(Database& database, const Digest& robot, std::string_view task) {
  const std::optional<ExperienceKey> key = find_experience(database, robot, task);
  if (!key)
    return 0;
  const auto query =
      database.cached("SELECT generation FROM experience WHERE task_id = ? AND robot_id = ?");
  return query->bind_all(key->task_id, key->robot_id).step() ? count_of(*query, 0) : 0;
}

std::vector<ExperienceSummary> experience_of(Database& database, std::string_view task) {
  RobotNames names(database);
  const auto query = database.cached(
      "SELECT robot_id, paths, generation, retired_generation, dropped FROM experience "
      "WHERE task_id = (SELECT id FROM task WHERE name = ?) AND generation > 0");
  query->bind(1, task);
  std::vector<ExperienceSummary> robots;
  while (query->step())
    if (const RobotNames::Name* const robot = names.find(query->column_integer(0)))
      robots.push_back({.robot = robot->digest,
                        .paths = count_of(*query, 1),
                        .generation = count_of(*query, 2),
                        .retired_generation = count_of(*query, 3),
                        .dropped = count_of(*query, 4)});
  std::ranges::sort(robots, {}, &ExperienceSummary::robot);
  return robots;
}

AttemptTotals totals_of(Database& database, const Digest& robot, std::string_view task) {
  const std::optional<ExperienceKey> key = find_experience(database, robot, task);
  if (!key)
    return {};
  const auto query = database.cached("SELECT " + std::string(kTotalsColumns) +
                                     "FROM experience WHERE task_id = ? AND robot_id = ?");
  if (!query->bind_all(key->task_id, key->robot_id).step())
    return {};
  AttemptTotals totals = read_totals(*query);
  totals.recent = recent_of(database, *key);
  return totals;
}

}  // namespace kinship::store
