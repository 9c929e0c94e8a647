#include "server/store/tables/experience.hpp"

#include <algorithm>
#include <map>
#include <string>

#include "server/store/tables/pages.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/recent_attempts.hpp"

namespace kinship::store {
namespace {

/// Parameters $1 task, $2 robot.
std::string of_robot_and_task(Session& session) {
  return "FROM experience WHERE " + session.is_intact("experience") +
         " AND task_id = " + id_of_task(session, "$1") +
         " AND robot_id = " + id_of_robot(session, "$2");
}

/// What `find` finds with of_robot_and_task(), or nothing.
/// \throws Failure(Storage) if there is a row, but it, its robot's or its task's is damaged.
template <typename Find>
std::invoke_result_t<Find> find_undamaged(Session& session, const Digest& robot,
                                          std::string_view task, Find find) {
  std::invoke_result_t<Find> found = find();
  if (found)
    return found;
  // By the index by robots: the table itself, which is one by tasks, has just been asked.
  if (!session.find_integer("SELECT 1 FROM experience"
                            " WHERE +task_id = (SELECT id FROM task WHERE name = $1)"
                            " AND robot_id = (SELECT id FROM robot WHERE digest = $2)",
                            task, robot)) {
    session.require_absent("robot", "digest", Parameter(robot));
    session.require_absent("task", "name", Parameter(task));
    return found;
  }
  found = find();  // the first report may have come between
  if (!found)
    throw Failure(ErrorCode::Storage, "robot " + robot.short_hex() + ", task '" +
                                          std::string(task) +
                                          "': a row of its experience is damaged");
  return found;
}

/// Parameter $1 task.
std::string robots_of_task(Session& session) {
  return " WHERE " + session.is_intact("experience") +
         " AND task_id = " + id_of_task(session, "$1") + " AND generation > 0";
}

/// \param row  has paths, generation, retired generation and dropped ones from column 1 on.
ExperienceSummary read_experience(const Digest& robot, const Row& row) {
  return {.robot = robot,
          .paths = count_of(row, 1),
          .generation = count_of(row, 2),
          .retired_generation = count_of(row, 3),
          .dropped = count_of(row, 4)};
}

/// In pages: a robot that has enough of them soon is the rule.
void add_newest(Session& session, const ExperienceKey& key, RecentAttempts& recent) {
  constexpr std::int64_t kPage = 1000;
  for (std::int64_t skipped = 0; skipped < kMaxRecentRows; skipped += kPage) {
    std::int64_t rows = 0;
    for (const Row& row : session.query(
             "SELECT " + std::string(RecentAttempts::kColumns) +
                 "FROM attempt WHERE task_id = $1 AND robot_id = $2 AND " +
                 session.is_intact("attempt") + " ORDER BY " +
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

/// The newest judged attempts of each sampling mode, oldest first. Looks at the newest
/// kMaxRecentRows alone.
std::vector<KnownAttempt> recent_of(Session& session, const ExperienceKey& key) {
  RecentAttempts recent;
  add_newest(session, key, recent);
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
  const std::optional<std::int64_t> generation = find_undamaged(session, robot, task, [&] {
    return session.find_integer("SELECT generation " + of_robot_and_task(session), task, robot);
  });
  return static_cast<std::uint64_t>(generation.value_or(0));
}

std::vector<ExperienceSummary> experience_of(Session& session, std::string_view task) {
  constexpr int kRobotId = 5, kIsIntact = 6;
  std::vector<ExperienceSummary> robots;
  std::map<std::int64_t, std::size_t> damaged;  // places of robots with damaged rows, by id
  for (const Row& row : session.query(
           "SELECT digest, paths, generation, retired_generation, dropped, robot_id, " +
               session.is_intact("robot") + " FROM experience JOIN robot ON robot.id = robot_id" +
               robots_of_task(session),
           task)) {
    if (row.column_integer(kIsIntact) == 0)
      damaged.emplace(row.column_integer(kRobotId), robots.size());
    robots.push_back(read_experience(id_of<Digest>(row.column_blob(0)), row));
  }
  if (!damaged.empty())
    for (const auto& [id, name] : select_robot_names(session))
      if (const auto place = damaged.find(id); place != damaged.end())
        robots[place->second].robot = name.digest;
  std::ranges::sort(robots, {}, &ExperienceSummary::robot);
  return robots;
}

AttemptTotals totals_of(Session& session, const Digest& robot, std::string_view task) {
  constexpr int kTask = 10, kRobot = 11;
  ExperienceKey key;
  std::optional<AttemptTotals> totals =
      find_undamaged(session, robot, task, [&]() -> std::optional<AttemptTotals> {
        const Rows rows = session.query("SELECT " + std::string(kTotalsColumns) +
                                            ", task_id, robot_id " + of_robot_and_task(session),
                                        task, robot);
        if (rows.empty())
          return std::nullopt;
        const Row& row = rows.front();
        key = {row.column_integer(kTask), row.column_integer(kRobot)};
        return read_totals(row);
      });
  if (!totals)
    return {};
  totals->recent = recent_of(session, key);
  return *std::move(totals);
}

}  // namespace kinship::store
