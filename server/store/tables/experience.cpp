#include "server/store/tables/experience.hpp"

#include <algorithm>
#include <map>
#include <string>

#include "server/store/tables/robots.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/recent_attempts.hpp"

namespace kinship::store {
namespace {

constexpr std::string_view kOfRobotAndTask =
    "FROM experience WHERE task_id = (SELECT id FROM task WHERE name = $1)"
    " AND robot_id = (SELECT id FROM robot WHERE digest = $2)";

constexpr std::string_view kRobotsOfTask =
    " WHERE task_id = (SELECT id FROM task WHERE name = $1) AND generation > 0";

/// \param row  has paths, generation, retired generation and dropped ones from column 1 on.
ExperienceSummary read_experience(const Digest& robot, const Row& row) {
  return {.robot = robot,
          .paths = count_of(row, 1),
          .generation = count_of(row, 2),
          .retired_generation = count_of(row, 3),
          .dropped = count_of(row, 4)};
}

/// In pages: a robot that has enough of them soon is the rule. Stops at a damaged row.
void add_newest(Session& session, const ExperienceKey& key, RecentAttempts& recent) {
  constexpr std::int64_t kPage = 1000;
  for (std::int64_t skipped = 0; skipped < kMaxRecentRows; skipped += kPage) {
    std::int64_t rows = 0;
    for (const Row& row : session.query(
             "SELECT " + std::string(RecentAttempts::kColumns) +
                 "FROM attempt WHERE task_id = $1 AND robot_id = $2 ORDER BY " +
                 std::string(session.dialect().newest_attempts_first) + " LIMIT $3 OFFSET $4",
             key.task_id, key.robot_id, kPage, skipped)) {
      if (recent.complete())
        return;
      recent.add(row);
      ++rows;
    }
    if (rows < kPage)
      return;
  }
}

/// One by one, by the ids of an index, without unreadable ones.
void add_newest_readable(Session& session, const ExperienceKey& key, RecentAttempts& recent) {
  for (const Row& id :
       session.query("SELECT id FROM attempt WHERE task_id = $1 AND robot_id = $2 ORDER BY " +
                         std::string(session.dialect().newest_attempts_first) + " LIMIT $3",
                     key.task_id, key.robot_id, kMaxRecentRows)) {
    if (recent.complete())
      return;
    static_cast<void>(session.unless_damaged([&] {
      for (const Row& row : session.query(
               "SELECT " + std::string(RecentAttempts::kColumns) + "FROM attempt WHERE id = $1",
               id.column_integer(0)))
        recent.add(row);
      return true;
    }));
  }
}

/// The newest judged attempts of each sampling mode, oldest first. Looks at the newest
/// kMaxRecentRows alone.
std::vector<KnownAttempt> recent_of(Session& session, const ExperienceKey& key) {
  RecentAttempts recent;
  const bool is_whole = session.unless_damaged([&] {
    add_newest(session, key, recent);
    return true;
  });
  if (!is_whole) {
    recent = {};
    add_newest_readable(session, key, recent);
  }
  return recent.oldest_first();
}

/// \param column  that has this value.
std::vector<ExperienceKey> lock_pairs(Session& session, const std::string& column,
                                      std::int64_t value) {
  std::vector<ExperienceKey> keys;
  for (const Row& row : session.query("SELECT task_id, robot_id FROM experience WHERE " + column +
                                          " = $1 ORDER BY task_id, robot_id" +
                                          std::string(session.dialect().lock_experience),
                                      value))
    keys.push_back({row.column_integer(0), row.column_integer(1)});
  return keys;
}

}  // namespace

std::vector<ExperienceKey> lock_pairs_of_robot(Session& session, std::int64_t robot_id) {
  return lock_pairs(session, "robot_id", robot_id);
}

std::vector<ExperienceKey> lock_pairs_of_task(Session& session, std::int64_t task_id) {
  return lock_pairs(session, "task_id", task_id);
}

std::uint64_t generation_of(Session& session, const Digest& robot, std::string_view task) {
  return static_cast<std::uint64_t>(
      session.find_integer("SELECT generation " + std::string(kOfRobotAndTask), task, robot)
          .value_or(0));
}

std::vector<ExperienceSummary> experience_of(Session& session, std::string_view task) {
  std::vector<ExperienceSummary> robots;
  const bool is_whole = session.unless_damaged([&] {
    for (const Row& row : session.query(
             "SELECT digest, paths, generation, retired_generation, dropped FROM experience"
             " JOIN robot ON robot.id = robot_id" +
                 std::string(kRobotsOfTask),
             task))
      robots.push_back(read_experience(id_of<Digest>(row.column_blob(0)), row));
    return true;
  });
  if (!is_whole) {  // a robot's row, whose digest is in an index too
    robots.clear();
    const std::map<std::int64_t, RobotName> names = select_robot_names(session);
    for (const Row& row : session.query(
             "SELECT robot_id, paths, generation, retired_generation, dropped FROM experience" +
                 std::string(kRobotsOfTask),
             task))
      if (const auto robot = names.find(row.column_integer(0)); robot != names.end())
        robots.push_back(read_experience(robot->second.digest, row));
  }
  std::ranges::sort(robots, {}, &ExperienceSummary::robot);
  return robots;
}

AttemptTotals totals_of(Session& session, const Digest& robot, std::string_view task) {
  const Rows rows = session.query("SELECT " + std::string(kTotalsColumns) + ", task_id, robot_id " +
                                      std::string(kOfRobotAndTask),
                                  task, robot);
  if (rows.empty())
    return {};
  constexpr int kTask = 10, kRobot = 11;
  const Row& row = rows.front();
  AttemptTotals totals = read_totals(row);
  totals.recent = recent_of(session, {row.column_integer(kTask), row.column_integer(kRobot)});
  return totals;
}

}  // namespace kinship::store
