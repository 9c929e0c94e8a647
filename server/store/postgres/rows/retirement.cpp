#include "server/store/postgres/rows/retirement.hpp"

#include <optional>
#include <string>
#include <utility>

#include "server/store/postgres/rows/experience_rows.hpp"
#include "server/store/tables/audit.hpp"
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

/// Of a pair that is locked. A damaged path was in fits before it was found damaged: it is retired
/// as any other, but was taken out of the count already.
/// \return how many were not retired before.
std::int64_t retire(Connection& connection, const ExperienceKey& key,
                    const std::vector<std::int64_t>& paths) {
  const Rows rows = connection.query(
      "WITH gone AS (UPDATE path SET retired_ms = $2 WHERE id = ANY($1) AND retired_ms IS NULL"
      "  RETURNING id, report_uuid, damaged_ms),"
      " remembered AS (INSERT INTO retired_report (report_uuid, retired_ms)"
      "  SELECT report_uuid, $2 FROM gone UNION"
      "  SELECT attempt.report_uuid, $2 FROM attempt JOIN gone ON attempt.path_id = gone.id"
      "  WHERE attempt.status = 2 ON CONFLICT (report_uuid) DO NOTHING)"
      " SELECT count(*), count(*) FILTER (WHERE damaged_ms IS NULL) FROM gone",
      paths, now_ms());
  const std::int64_t retired = rows.front().column_integer(0);
  if (retired > 0)
    note_retirement(connection, key, rows.front().column_integer(1));
  return retired;
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
  note_act(connection, audit, AuditOutcome::Done, describe_paths(retired.task, before),
           in_number(count_paths_of(connection, retired.task), "path"));
  return retired;
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

void set_aside(Connection& connection, const DamagedRows& damaged) {
  connection.query(
      "SELECT 1 FROM experience WHERE (task_id, robot_id) IN"
      " (SELECT found.task_id, found.robot_id FROM unnest($1) AS wanted (id) CROSS JOIN LATERAL"
      "  (SELECT task_id, robot_id FROM path WHERE path.id = wanted.id OFFSET 0) AS found)"
      " ORDER BY task_id, robot_id FOR NO KEY UPDATE",
      damaged.paths);
  connection.query(
      "WITH aside AS (UPDATE path SET damaged_ms = $2 WHERE id = ANY($1) AND damaged_ms IS NULL"
      "  RETURNING task_id, robot_id, retired_ms),"
      " lost AS (SELECT task_id, robot_id, count(*) AS paths FROM aside WHERE retired_ms IS NULL"
      "  GROUP BY task_id, robot_id)"
      " UPDATE experience SET changed_in = pg_current_xact_id(), generation = generation + 1, "
      "paths = experience.paths - lost.paths"
      " FROM lost WHERE experience.task_id = lost.task_id AND experience.robot_id = lost.robot_id",
      damaged.paths, now_ms());
  connection.query("UPDATE scene SET damaged_ms = $2 WHERE id = ANY($1) AND damaged_ms IS NULL",
                   damaged.scenes, now_ms());
}

}  // namespace kinship::store::postgres
