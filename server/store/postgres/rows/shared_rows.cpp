#include "server/store/postgres/rows/shared_rows.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "server/store/postgres/rows/experience_rows.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/pages.hpp"
#include "server/store/values/path_content.hpp"
#include "server/store/values/robot_columns.hpp"
#include "server/store/values/scene_columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store::postgres {
namespace {

/// Where a row stands in the order of transactions.
struct FeedPlace {
  std::int64_t transaction = 0;
  std::int64_t id = 0;
};

FeedPlace place_of_cursor(std::string_view cursor) {
  FeedPlace place;
  if (cursor.empty())
    return place;
  const char* const end = cursor.data() + cursor.size();
  const auto first = std::from_chars(cursor.data(), end, place.transaction);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != ':' || place.transaction < 0)
    refuse_cursor(cursor);
  const auto second = std::from_chars(first.ptr + 1, end, place.id);
  if (second.ec != std::errc() || second.ptr != end || place.id < 0)
    refuse_cursor(cursor);
  return place;
}

/// Of rows that begin with transaction and id, one more than asked for.
/// \param read  makes a row of the feed of a row.
template <typename Entry, typename Read>
Feed<Entry> feed_of(const Rows& rows, std::string_view cursor, std::size_t limit, Read read) {
  Feed<Entry> feed;
  feed.cursor = cursor;
  for (const Row row : rows) {
    if (feed.rows.size() == limit) {
      feed.has_more = true;
      return feed;
    }
    feed.rows.push_back(read(row));
    feed.cursor =
        std::to_string(row.column_integer(0)) + ":" + std::to_string(row.column_integer(1));
  }
  return feed;
}

/// The next $3 behind ($1, $2), of which nothing is on its way any more.
constexpr std::string_view kNextSettled =
    "(arrived_in, id) > ($1::text::xid8, $2) AND"
    " arrived_in < pg_snapshot_xmin(pg_current_snapshot()) ORDER BY arrived_in, id LIMIT $3";

std::vector<Bytes> bytes_of(std::span<const Uuid> reports) {
  std::vector<Bytes> bytes;
  bytes.reserve(reports.size());
  for (const Uuid& report : reports)
    bytes.emplace_back(report.bytes);
  return bytes;
}

/// Of its path, or what replaced that one; a dropped one is not retired.
/// OFFSET 0 keeps PostgreSQL from reading all of a table for the rows of a page, whose number it
/// does not know.
constexpr std::string_view kIsRetired =
    " EXISTS (SELECT 1 FROM retired_report"
    "  WHERE retired_report.report_uuid = attempt.report_uuid OFFSET 0)"
    " OR coalesce(path.retired_ms IS NOT NULL AND length(path.waypoints) > 1, FALSE) ";
constexpr std::string_view kPathOfAttempt =
    "LEFT JOIN LATERAL (SELECT id, replaced_by FROM path AS found"
    " WHERE found.id = attempt.path_id OFFSET 0) AS named ON TRUE "
    "LEFT JOIN LATERAL (SELECT id, retired_ms, waypoints, dof, waypoint_count FROM path AS found"
    " WHERE found.id = coalesce(named.replaced_by, named.id) OFFSET 0) AS path ON TRUE ";

/// A report without its path and scene, and where these are.
struct SharedRow {
  SharedReport report;
  std::optional<std::int64_t> path_id, scene_id;
  std::size_t bytes = 0;  ///< of waypoints and of the scene, about
  bool is_robot_removed = false;
};

SharedRow read_shared_row(const Row& row) {
  constexpr int kFirstOfRecord = 13;
  SharedRow shared;
  Attempt& attempt = shared.report.attempt;
  attempt.report_uuid = id_of<Uuid>(row.column_blob(0));
  attempt.robot = id_of<Digest>(row.column_blob(1));
  shared.is_robot_removed = is_removed_label(row.column_text(2));
  attempt.task = row.column_text(3);
  attempt.machine = row.column_text(4);
  attempt.T_task_base = pose_from_blob(row.column_blob(5));
  shared.report.body = id_of<Digest>(row.column_blob(6));
  shared.report.received_ms = row.column_integer(7);
  shared.report.is_retired = row.column_integer(8) != 0;
  shared.path_id = optional_integer_of(row, 9);
  shared.bytes = count_of(row, 10) + count_of(row, 11);
  shared.scene_id = optional_integer_of(row, 12);
  attempt.record = read_record(row, kFirstOfRecord);
  return shared;
}

std::map<Uuid, SharedRow> select_rows(Connection& connection, std::span<const Uuid> reports) {
  const Rows rows = connection.query(
      "SELECT attempt.report_uuid, robot.digest, robot.label, task.name, attempt.machine,"
      " attempt.T_task_base, attempt.body_sha256, attempt.received_ms," +
          std::string(kIsRetired) +
          ", path.id, 8 * path.dof * path.waypoint_count, scene.size, scene.id, " +
          std::string(kRecordColumns) +
          "FROM attempt JOIN robot ON robot.id = attempt.robot_id"
          " JOIN task ON task.id = attempt.task_id " +
          std::string(kPathOfAttempt) +
          "LEFT JOIN LATERAL (SELECT id, size FROM scene AS found WHERE found.id = attempt.scene_id"
          " AND found.damaged_ms IS NULL OFFSET 0) AS scene ON TRUE "
          "WHERE attempt.report_uuid = ANY ($1)",
      bytes_of(reports));
  std::map<Uuid, SharedRow> found;
  for (const Row row : rows) {
    SharedRow shared = read_shared_row(row);
    const Uuid report = shared.report.attempt.report_uuid;
    found.emplace(report, std::move(shared));
  }
  return found;
}

std::map<std::int64_t, Path> select_shared_paths(Connection& connection,
                                                 const std::vector<std::int64_t>& ids,
                                                 SharedRead& noted) {
  std::map<std::int64_t, Path> paths;
  if (ids.empty())
    return paths;
  const Rows rows = connection.query("SELECT " + std::string(kPathColumns) +
                                         "FROM path WHERE id = ANY ($1) AND damaged_ms IS NULL"
                                         " AND length(waypoints) > 1",
                                     ids);
  for (const Row row : rows)
    if (std::optional<StoredPath> stored = read_path(row))
      paths.emplace(stored->id, std::move(stored->path));
    else
      noted.damaged.paths.push_back(row.column_integer(PathColumn::kId));
  return paths;
}

std::map<std::int64_t, RecordedScene> select_shared_scenes(Connection& connection,
                                                           const std::vector<std::int64_t>& ids,
                                                           SharedRead& noted) {
  std::map<std::int64_t, RecordedScene> scenes;
  if (ids.empty())
    return scenes;
  const Rows rows = connection.query("SELECT " + std::string(kSceneColumns) +
                                         "FROM scene WHERE id = ANY ($1) AND damaged_ms IS NULL",
                                     ids);
  for (const Row row : rows)
    if (std::optional<RecordedScene> scene = read_scene_columns(row))
      scenes.emplace(row.column_integer(0), std::move(*scene));
    else
      noted.damaged.scenes.push_back(row.column_integer(0));
  return scenes;
}

/// Paths in use, or damaged, of a pair that is locked. As any retirement, it names all reports of
/// their content. \return how many were not retired before.
std::int64_t retire_paths_of(Connection& connection, const ExperienceKey& key,
                             const std::vector<Bytes>& reports) {
  const Rows rows = connection.query(
      "WITH gone AS (UPDATE path SET retired_ms = $4 WHERE retired_ms IS NULL AND id IN"
      "  (SELECT coalesce(named.replaced_by, named.id) FROM attempt"
      "   JOIN path AS named ON named.id = attempt.path_id WHERE attempt.task_id = $1"
      "   AND attempt.robot_id = $2 AND attempt.report_uuid = ANY ($3))"
      "  RETURNING id, report_uuid, damaged_ms),"
      " remembered AS (INSERT INTO retired_report (report_uuid, retired_ms)"
      "  SELECT report_uuid, $4 FROM gone UNION"
      "  SELECT attempt.report_uuid, $4 FROM attempt JOIN gone ON attempt.path_id = gone.id"
      "  WHERE attempt.status = 2 ON CONFLICT (report_uuid) DO NOTHING)"
      " SELECT count(*), count(*) FILTER (WHERE damaged_ms IS NULL) FROM gone",
      key.task_id, key.robot_id, reports, now_ms());
  const std::int64_t retired = rows.front().column_integer(0);
  if (retired > 0)
    note_retirement(connection, key, rows.front().column_integer(1));
  return retired;
}

/// Where some of these are not there: waits for whoever is writing reports (kBeforeReports), and
/// keeps others from it. Of two that look for what the other one writes neither would find it.
void wait_for_arrivals(Connection& connection, std::span<const Uuid> reports) {
  const std::set<Uuid> asked(reports.begin(), reports.end());
  if (select_known(connection, reports).size() < asked.size())
    connection.query("SELECT pg_advisory_xact_lock(20261126) IS NULL");
}

}  // namespace

Feed<ArrivedReport> feed_of_arrivals(Connection& connection, std::string_view task,
                                     std::string_view cursor, std::size_t limit) {
  const FeedPlace after = place_of_cursor(cursor);
  Parameters parameters(after.transaction, after.id, static_cast<std::int64_t>(limit) + 1);
  std::string page = "SELECT id FROM attempt WHERE " + std::string(kNextSettled);
  if (!task.empty()) {
    parameters.add(task);
    page =
        "SELECT next.id FROM experience CROSS JOIN LATERAL (SELECT arrived_in, id FROM attempt "
        "WHERE task_id = experience.task_id AND robot_id = experience.robot_id AND " +
        std::string(kNextSettled) +
        ") AS next WHERE experience.task_id = (SELECT id FROM task WHERE name = $4)"
        " ORDER BY next.arrived_in, next.id LIMIT $3";
  }
  const Rows rows =
      connection.query("SELECT attempt.arrived_in::text::bigint, attempt.id, attempt.report_uuid," +
                           std::string(kIsRetired) + "FROM (" + page +
                           ") AS page CROSS JOIN LATERAL (SELECT * FROM attempt AS found"
                           " WHERE found.id = page.id OFFSET 0) AS attempt " +
                           std::string(kPathOfAttempt) + "ORDER BY attempt.arrived_in, attempt.id",
                       parameters);
  return feed_of<ArrivedReport>(rows, cursor, limit, [](const Row& row) {
    return ArrivedReport{id_of<Uuid>(row.column_blob(2)), row.column_integer(3) != 0};
  });
}

Feed<Uuid> feed_of_retirements(Connection& connection, std::string_view cursor, std::size_t limit) {
  const FeedPlace after = place_of_cursor(cursor);
  const Rows rows = connection.query(
      // By another name: the rows are to come in the order of the column, which an index has.
      "SELECT arrived_in::text::bigint AS place, id, report_uuid FROM retired_report WHERE " +
          std::string(kNextSettled),
      after.transaction, after.id, static_cast<std::int64_t>(limit) + 1);
  return feed_of<Uuid>(rows, cursor, limit,
                       [](const Row& row) { return id_of<Uuid>(row.column_blob(2)); });
}

std::set<Uuid> select_known(Connection& connection, std::span<const Uuid> reports) {
  std::set<Uuid> known;
  const Rows rows = connection.query("SELECT report_uuid FROM attempt WHERE report_uuid = ANY ($1)",
                                     bytes_of(reports));
  for (const Row row : rows)
    known.insert(id_of<Uuid>(row.column_blob(0)));
  return known;
}

SharedRead select_shared(Connection& connection, std::span<const Uuid> reports,
                         std::size_t max_bytes) {
  SharedRead read;
  std::map<Uuid, SharedRow> rows = select_rows(connection, reports);
  std::vector<std::int64_t> path_ids, scene_ids;
  std::size_t bytes = 0;
  for (const Uuid& report : reports) {
    if (read.found.looked_at > 0 && bytes > max_bytes)
      break;
    ++read.found.looked_at;
    const auto found = rows.find(report);
    if (found == rows.end() || found->second.is_robot_removed)
      continue;
    bytes += found->second.bytes;
    if (found->second.path_id)
      path_ids.push_back(*found->second.path_id);
    if (found->second.scene_id)
      scene_ids.push_back(*found->second.scene_id);
  }
  const std::map<std::int64_t, Path> paths = select_shared_paths(connection, path_ids, read);
  const std::map<std::int64_t, RecordedScene> scenes =
      select_shared_scenes(connection, scene_ids, read);
  for (const Uuid& report : reports.first(read.found.looked_at)) {
    const auto found = rows.find(report);
    if (found == rows.end() || found->second.is_robot_removed)
      continue;
    SharedReport& shared = found->second.report;
    if (found->second.path_id)
      if (const auto path = paths.find(*found->second.path_id); path != paths.end())
        shared.attempt.path = path->second;
    if (found->second.scene_id)
      if (const auto scene = scenes.find(*found->second.scene_id); scene != scenes.end())
        shared.attempt.scene = scene->second;
    if (shared.attempt.path.has_value() == (shared.attempt.record.outcome == Outcome::Solved))
      read.found.reports.push_back(std::move(shared));
  }
  return read;
}

std::vector<Retirement> retire_reports(Connection& connection, std::span<const Uuid> reports) {
  const std::vector<Bytes> uuids = bytes_of(reports);
  wait_for_arrivals(connection, reports);
  std::map<std::string, Retirement> retired;  // by task
  // Locked before anything is written, in the order of the key as everybody does.
  const Rows pairs = connection.query(
      "SELECT attempt.task_id, attempt.robot_id, task.name, robot.digest FROM attempt"
      " JOIN task ON task.id = task_id JOIN robot ON robot.id = robot_id"
      " WHERE report_uuid = ANY ($1) GROUP BY 1, 2, 3, 4 ORDER BY 1, 2",
      uuids);
  for (const Row pair : pairs)
    lock_pair(connection, {pair.column_integer(0), pair.column_integer(1)});
  // Also what was there is written, so that the answer waits for a standby.
  connection.query(
      "INSERT INTO retired_report (report_uuid, retired_ms)"
      " SELECT DISTINCT unnest($1::bytea[]), $2::bigint ON CONFLICT (report_uuid)"
      " DO UPDATE SET retired_ms = retired_report.retired_ms",
      uuids, now_ms());
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

}  // namespace kinship::store::postgres
