#include "server/store/postgres/rows/experience_rows.hpp"

#include <string>

#include "server/store/values/columns.hpp"
#include "server/store/values/recent_attempts.hpp"

namespace kinship::store::postgres {
namespace {

std::vector<ExperienceKey> keys_in(const Rows& rows) {
  std::vector<ExperienceKey> keys;
  for (const Row row : rows)
    keys.push_back({row.column_integer(0), row.column_integer(1)});
  return keys;
}

}  // namespace

std::uint64_t generation_of(Connection& connection, const Digest& robot, std::string_view task) {
  const Rows rows = connection.query(
      "SELECT generation FROM experience WHERE task_id = (SELECT id FROM task WHERE name = $1)"
      " AND robot_id = (SELECT id FROM robot WHERE digest = $2)",
      task, Bytes(robot.bytes));
  return rows.empty() ? 0 : count_of(rows.front(), 0);
}

std::vector<ExperienceSummary> experience_of(Connection& connection, std::string_view task) {
  std::vector<ExperienceSummary> robots;
  for (const Row row : connection.query(
           "SELECT robot.digest, paths, generation, retired_generation, dropped FROM experience"
           " JOIN robot ON robot.id = experience.robot_id"
           " WHERE task_id = (SELECT id FROM task WHERE name = $1) AND generation > 0"
           " ORDER BY robot.digest",
           task))
    robots.push_back({.robot = id_of<Digest>(row.column_blob(0)),
                      .paths = count_of(row, 1),
                      .generation = count_of(row, 2),
                      .retired_generation = count_of(row, 3),
                      .dropped = count_of(row, 4)});
  return robots;
}

AttemptTotals totals_of(Connection& connection, const Digest& robot, std::string_view task) {
  const Rows rows = connection.query("SELECT " + std::string(kTotalsColumns) +
                                         ", task_id, robot_id FROM experience"
                                         " WHERE task_id = (SELECT id FROM task WHERE name = $1)"
                                         " AND robot_id = (SELECT id FROM robot WHERE digest = $2)",
                                     task, Bytes(robot.bytes));
  if (rows.empty())
    return {};
  constexpr int kTask = 10, kRobot = 11;
  AttemptTotals totals = read_totals(rows.front());
  RecentAttempts recent;
  // In pages: a mode that has enough of them soon is the rule.
  constexpr std::int64_t kPage = 1000;
  for (std::int64_t skipped = 0; skipped < kMaxRecentRows && !recent.complete(); skipped += kPage) {
    const Rows page = connection.query("SELECT " + std::string(RecentAttempts::kColumns) +
                                           "FROM attempt WHERE task_id = $1 AND robot_id = $2"
                                           " ORDER BY arrived_in DESC, id DESC OFFSET $3 LIMIT $4",
                                       rows.front().column_integer(kTask),
                                       rows.front().column_integer(kRobot), skipped, kPage);
    for (const Row row : page)
      if (!recent.complete())
        recent.add(row);
    if (page.size() < kPage)
      break;
  }
  totals.recent = recent.oldest_first();
  return totals;
}

std::vector<ExperienceKey> lock_pairs_of_robot(Connection& connection, std::int64_t robot_id) {
  return keys_in(
      connection.query("SELECT task_id, robot_id FROM experience WHERE robot_id = $1"
                       " ORDER BY task_id, robot_id FOR NO KEY UPDATE",
                       robot_id));
}

std::vector<ExperienceKey> lock_pairs_of_task(Connection& connection, std::int64_t task_id) {
  return keys_in(
      connection.query("SELECT task_id, robot_id FROM experience WHERE task_id = $1"
                       " ORDER BY task_id, robot_id FOR NO KEY UPDATE",
                       task_id));
}

void lock_pair(Connection& connection, const ExperienceKey& key) {
  connection.query(
      "SELECT 1 FROM experience WHERE task_id = $1 AND robot_id = $2"
      " FOR NO KEY UPDATE",
      key.task_id, key.robot_id);
}

void note_retirement(Connection& connection, const ExperienceKey& key, std::int64_t paths) {
  connection.query(
      "UPDATE experience SET changed_in = pg_current_xact_id(), generation = generation + 1,"
      " retired_generation = generation + 1, paths = paths - $3"
      " WHERE task_id = $1 AND robot_id = $2",
      key.task_id, key.robot_id, paths);
}

}  // namespace kinship::store::postgres
