#include "server/store/postgres/rows/retirement.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "server/store/postgres/rows/arrivals.hpp"
#include "server/store/tables/audit.hpp"
#include "server/store/tables/searches.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store::postgres {
namespace {

/// The attempt of a report, as far as a retirement goes.
struct ReportedPath {
  ExperienceKey key;
  std::optional<std::int64_t> path_id;
  bool is_solved = false;
  std::string task;
  Digest robot;
};

std::optional<ReportedPath> find_reported(Connection& connection, const Uuid& report_uuid) {
  const Rows rows = connection.query(
      "SELECT task_id, robot_id, path_id, outcome, task.name, robot.digest FROM attempt"
      " JOIN task ON task.id = task_id JOIN robot ON robot.id = robot_id WHERE report_uuid = $1",
      Bytes(report_uuid.bytes));
  if (rows.empty())
    return std::nullopt;
  const Row row = rows.front();
  return ReportedPath{.key = {row.column_integer(0), row.column_integer(1)},
                      .path_id = optional_integer_of(row, 2),
                      .is_solved = outcome_of(row.column_integer(3)) == Outcome::Solved,
                      .task = std::string(row.column_text(4)),
                      .robot = id_of<Digest>(row.column_blob(5))};
}

void lock_pair(Connection& connection, const ExperienceKey& key) {
  connection.query(
      "SELECT 1 FROM experience WHERE task_id = $1 AND robot_id = $2"
      " FOR NO KEY UPDATE",
      key.task_id, key.robot_id);
}

/// Notes a retirement in a locked row: both generations rise.
/// \param paths  that were counted until now.
void note_retirement(Connection& connection, const ExperienceKey& key, std::int64_t paths) {
  connection.query(
      "UPDATE experience SET changed_in = pg_current_xact_id(), generation = generation + 1,"
      " retired_generation = generation + 1, paths = paths - $3"
      " WHERE task_id = $1 AND robot_id = $2",
      key.task_id, key.robot_id, paths);
}

/// Of a pair that is locked: retires paths, and remembers all reports of their content. A damaged
/// path was in fits before it was found damaged: it is retired as any other, but was taken out of
/// the count already.
/// \param which  of the ids of paths; $1 is the time.
/// \return how many were not retired before.
std::int64_t retire(Connection& connection, const ExperienceKey& key, const std::string& which,
                    const Parameters& parameters) {
  const Rows rows = connection.query(
      "WITH gone AS (UPDATE path SET retired_ms = $1 WHERE retired_ms IS NULL AND id " + which +
          "  RETURNING id, report_uuid, damaged_ms),"
          " remembered AS (INSERT INTO retired_report (report_uuid, retired_ms)"
          "  SELECT report_uuid, $1 FROM gone UNION"
          "  SELECT attempt.report_uuid, $1 FROM attempt JOIN gone ON attempt.path_id = gone.id"
          "  WHERE attempt.status = 2 ON CONFLICT (report_uuid) DO NOTHING)"
          " SELECT count(*), count(*) FILTER (WHERE damaged_ms IS NULL) FROM gone",
      parameters);
  const std::int64_t retired = rows.front().column_integer(0);
  if (retired > 0)
    note_retirement(connection, key, rows.front().column_integer(1));
  return retired;
}

std::int64_t retire(Connection& connection, const ExperienceKey& key,
                    const std::vector<std::int64_t>& paths) {
  return retire(connection, key, "= ANY($2)", Parameters(now_ms(), paths));
}

/// Retires the paths of reports, or their replacements.
std::int64_t retire_paths_of(Connection& connection, const ExperienceKey& key,
                             const std::vector<Bytes>& reports) {
  return retire(connection, key,
                "IN (SELECT coalesce(named.replaced_by, named.id) FROM attempt"
                "   JOIN path AS named ON named.id = attempt.path_id WHERE attempt.task_id = $2"
                "   AND attempt.robot_id = $3 AND attempt.report_uuid = ANY ($4))",
                Parameters(now_ms(), key.task_id, key.robot_id, reports));
}

/// If some of these are missing: waits for transactions that write reports (kBeforeReports), and
/// holds off others. Two transactions that look for each other's reports would find none.
void wait_for_arrivals(Connection& connection, std::span<const Uuid> reports) {
  const std::set<Uuid> asked(reports.begin(), reports.end());
  if (select_known(connection, reports).size() < asked.size())
    connection.query("SELECT pg_advisory_xact_lock(20261126) IS NULL");
}

}  // namespace

Result<Retirement> retire_path(Connection& connection, const Uuid& report_uuid,
                               const AuditEntry* audit) {
  std::optional<ReportedPath> reported = find_reported(connection, report_uuid);
  if (!reported)
    return no_such_report(report_uuid);
  lock_pair(connection, reported->key);
  reported = find_reported(connection, report_uuid);  // as it is under the lock
  if (!reported->path_id)
    return report_without_path(report_uuid, reported->is_solved);
  Retirement retired;
  retired.task = reported->task;
  const std::int64_t before = count_paths_of(connection, retired.task);
  if (retire(connection, reported->key, {*reported->path_id}) > 0) {
    retired.paths = 1;
    add_robot(retired, reported->robot);
  }
  drop_search_of(connection, report_uuid);
  note_act(connection, audit, AuditOutcome::Done, describe_paths(retired.task, before),
           in_number(count_paths_of(connection, retired.task), "path"));
  return retired;
}

std::vector<Retirement> retire_reports(Connection& connection, std::span<const Uuid> reports) {
  const std::vector<Bytes> uuids = bytes_of(reports);
  wait_for_arrivals(connection, reports);
  std::map<std::string, Retirement> retired;  // by task
  // Locked before anything is written, in the order of the key as everywhere.
  const Rows pairs = connection.query(
      "SELECT attempt.task_id, attempt.robot_id, task.name, robot.digest FROM attempt"
      " JOIN task ON task.id = task_id JOIN robot ON robot.id = robot_id"
      " WHERE report_uuid = ANY ($1) GROUP BY 1, 2, 3, 4 ORDER BY 1, 2",
      uuids);
  for (const Row pair : pairs)
    lock_pair(connection, {pair.column_integer(0), pair.column_integer(1)});
  // Known reports are written, too, so that the answer waits for a standby.
  connection.query(
      "INSERT INTO retired_report (report_uuid, retired_ms)"
      " SELECT DISTINCT unnest($1::bytea[]), $2::bigint ON CONFLICT (report_uuid)"
      " DO UPDATE SET retired_ms = retired_report.retired_ms",
      uuids, now_ms());
  for (const Uuid& report : reports)
    drop_search_of(connection, report);
  for (const Row pair : pairs) {
    const std::int64_t paths =
        retire_paths_of(connection, {pair.column_integer(0), pair.column_integer(1)}, uuids);
    if (paths == 0)
      continue;
    Retirement& of_task = retired[std::string(pair.column_text(2))];
    of_task.task = pair.column_text(2);
    of_task.paths += static_cast<std::uint64_t>(paths);
    of_task.robots.push_back(id_of<Digest>(pair.column_blob(3)));
  }
  std::vector<Retirement> by_task;
  for (auto& [task, retirement] : retired) {
    std::ranges::sort(retirement.robots);
    by_task.push_back(std::move(retirement));
  }
  return by_task;
}

RetireSome retirement_in(Connection& connection) {
  return [&connection](const ExperienceKey& key, std::int64_t limit, std::int64_t last_id) {
    std::vector<std::int64_t> paths;
    for (const Row row : connection.query(
             "(SELECT id FROM path WHERE task_id = $1 AND robot_id = $2 AND id <= $3"
             "  AND retired_ms IS NULL AND damaged_ms IS NULL LIMIT $4)"
             " UNION ALL (SELECT id FROM path WHERE damaged_ms IS NOT NULL AND retired_ms IS NULL"
             "  AND replaced_by IS NULL AND task_id = $1 AND robot_id = $2 AND id <= $3) LIMIT $4",
             key.task_id, key.robot_id, last_id, limit))
      paths.push_back(row.column_integer(0));
    return paths.empty() ? std::int64_t{0} : retire(connection, key, paths);
  };
}

void quarantine(Connection& connection, const DamagedRows& damaged) {
  connection.query(
      "SELECT 1 FROM experience WHERE (task_id, robot_id) IN"
      " (SELECT found.task_id, found.robot_id FROM unnest($1) AS wanted (id) CROSS JOIN LATERAL"
      "  (SELECT task_id, robot_id FROM path WHERE path.id = wanted.id OFFSET 0) AS found)"
      " ORDER BY task_id, robot_id FOR NO KEY UPDATE",
      damaged.paths);
  connection.query(
      "WITH quarantined AS (UPDATE path SET damaged_ms = $2 WHERE id = ANY($1) AND damaged_ms IS "
      "NULL"
      "  RETURNING task_id, robot_id, retired_ms),"
      " lost AS (SELECT task_id, robot_id, count(*) AS paths FROM quarantined WHERE retired_ms IS "
      "NULL"
      "  GROUP BY task_id, robot_id)"
      " UPDATE experience SET changed_in = pg_current_xact_id(), generation = generation + 1, "
      "paths = experience.paths - lost.paths"
      " FROM lost WHERE experience.task_id = lost.task_id AND experience.robot_id = lost.robot_id",
      damaged.paths, now_ms());
  connection.query("UPDATE scene SET damaged_ms = $2 WHERE id = ANY($1) AND damaged_ms IS NULL",
                   damaged.scenes, now_ms());
}

}  // namespace kinship::store::postgres
