#include "server/store/postgres/rows/arrivals.hpp"

#include <charconv>

#include "server/store/tables/pages.hpp"
#include "server/store/values/robot_columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store::postgres {
namespace {

/// Of an attempt, its robot and task, and its path or the replacement of that.
constexpr std::string_view kArrivedColumns =
    "SELECT attempt.arrived_in::text::bigint, attempt.id,"
    " attempt.arrived_in < pg_snapshot_xmin(pg_current_snapshot()), attempt.report_uuid,"
    " robot.digest, attempt.machine, task.name, attempt.T_task_base, robot.label,"
    " attempt.received_ms, path.id, path.retired_ms IS NULL AND path.damaged_ms IS NULL,"
    " 8 * path.dof * path.waypoint_count, attempt.scene_id, ";
constexpr int kFirstOfRecord = 14, kFirstBehindRecord = kFirstOfRecord + kRecordColumns;

constexpr std::string_view kNames =
    "JOIN robot ON robot.id = attempt.robot_id JOIN task ON task.id = attempt.task_id ";

/// OFFSET 0 keeps PostgreSQL from reading all of a table for the rows of a page, whose number it
/// does not know.
constexpr std::string_view kPathOfAttempt =
    "LEFT JOIN LATERAL (SELECT id, replaced_by FROM path AS found"
    " WHERE found.id = attempt.path_id OFFSET 0) AS named ON TRUE "
    "LEFT JOIN LATERAL (SELECT id, retired_ms, damaged_ms, waypoints, dof, waypoint_count"
    " FROM path AS found WHERE found.id = coalesce(named.replaced_by, named.id) OFFSET 0) AS path"
    " ON TRUE ";
constexpr std::string_view kAttemptOfPage =
    ") AS page CROSS JOIN LATERAL (SELECT * FROM attempt AS found WHERE found.id = page.id"
    " OFFSET 0) AS attempt ";

/// By its report, or its path; a dropped one is not retired.
constexpr std::string_view kReportIsRetired =
    " EXISTS (SELECT 1 FROM retired_report"
    "  WHERE retired_report.report_uuid = attempt.report_uuid OFFSET 0)"
    " OR coalesce(path.retired_ms IS NOT NULL AND length(path.waypoints) > 1, FALSE) ";

template <Columns Row>
ArrivedAttempt read_arrived(const Row& row) {
  ArrivedAttempt arrived;
  arrived.arrival = {row.column_integer(0), row.column_integer(1), row.column_integer(2) != 0};
  arrived.attempt.report_uuid = id_of<Uuid>(row.column_blob(3));
  arrived.attempt.robot = id_of<Digest>(row.column_blob(4));
  arrived.attempt.machine = row.column_text(5);
  arrived.attempt.task = row.column_text(6);
  arrived.attempt.T_task_base = pose_from_blob(row.column_blob(7));
  arrived.label = row.column_text(8);
  arrived.is_robot_removed = is_removed_label(arrived.label);
  arrived.received_ms = row.column_integer(9);
  arrived.path_id = optional_integer_of(row, 10);
  arrived.is_path_in_use = row.column_integer(11) != 0;
  arrived.waypoint_bytes = count_of(row, 12);
  arrived.scene_id = optional_integer_of(row, 13);
  arrived.attempt.record = read_record(row, kFirstOfRecord);
  return arrived;
}

/// The next $3 after ($1, $2): of all along an index; of some robots and tasks each brings its own.
/// \param condition  on an attempt, that it has to fulfil too.
std::string next_arrivals(Session& session, const PairFilter& filter,
                          std::vector<Parameter>& parameters, const std::string& condition = "") {
  const std::string next =
      "(arrived_in, id) > ($1::text::xid8, $2)" + condition + " ORDER BY arrived_in, id LIMIT $3";
  if (filter.is_empty())
    return "SELECT id FROM attempt WHERE " + next;
  return "SELECT next.id FROM experience CROSS JOIN LATERAL (SELECT arrived_in, id FROM attempt "
         "WHERE task_id = experience.task_id AND robot_id = experience.robot_id AND " +
         next + ") AS next WHERE TRUE" + filter.condition(session, "experience", parameters) +
         " ORDER BY next.arrived_in, next.id LIMIT $3";
}

/// Behind which nothing is on its way any more.
constexpr std::string_view kIsSettled = " AND arrived_in < pg_snapshot_xmin(pg_current_snapshot())";

/// \param row  begins with transaction and id.
std::string cursor_behind(const store::Row& row) {
  return cursor_of({row.column_integer(0), row.column_integer(1)});
}

std::vector<Parameter> next_of(const Arrival& after, std::int64_t count) {
  return {Parameter(after.transaction), Parameter(after.id), Parameter(count)};
}

}  // namespace

Arrival parse_arrival_cursor(std::string_view cursor) {
  Arrival arrival;
  if (cursor.empty())
    return arrival;
  const char* const end = cursor.data() + cursor.size();
  const auto first = std::from_chars(cursor.data(), end, arrival.transaction);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != ':' || arrival.transaction < 0)
    refuse_cursor(cursor);
  const auto second = std::from_chars(first.ptr + 1, end, arrival.id);
  if (second.ec != std::errc() || second.ptr != end || arrival.id < 0)
    refuse_cursor(cursor);
  return arrival;
}

std::string cursor_of(const Arrival& arrival) {
  return std::to_string(arrival.transaction) + ":" + std::to_string(arrival.id);
}

std::vector<Bytes> bytes_of(std::span<const Uuid> reports) {
  std::vector<Bytes> bytes;
  bytes.reserve(reports.size());
  for (const Uuid& report : reports)
    bytes.emplace_back(report.bytes);
  return bytes;
}

std::vector<ArrivedAttempt> select_arrived(Connection& connection, const PairFilter& filter,
                                           const Arrival& after, std::int64_t count) {
  std::vector<Parameter> parameters = next_of(after, count);
  const std::string page = next_arrivals(connection, filter, parameters);
  std::vector<ArrivedAttempt> arrived;
  for (const store::Row& row : connection.query_with(
           std::string(kArrivedColumns) + record_columns("attempt.") + "FROM (" + page +
               std::string(kAttemptOfPage) + std::string(kNames) + std::string(kPathOfAttempt) +
               "ORDER BY attempt.arrived_in, attempt.id",
           parameters))
    arrived.push_back(read_arrived(row));
  return arrived;
}

std::vector<ArrivedAttempt> select_arrived(Connection& connection, std::span<const Uuid> reports) {
  const Rows rows =
      connection.query(std::string(kArrivedColumns) + record_columns("attempt.") +
                           ", attempt.body_sha256," + std::string(kReportIsRetired) +
                           ", (SELECT size FROM scene WHERE scene.id = attempt.scene_id"
                           " AND scene.damaged_ms IS NULL) FROM attempt " +
                           std::string(kNames) + std::string(kPathOfAttempt) +
                           "WHERE attempt.report_uuid = ANY ($1)",
                       bytes_of(reports));
  std::vector<ArrivedAttempt> arrived;
  for (const Row row : rows) {
    ArrivedAttempt& each = arrived.emplace_back(read_arrived(row));
    each.body = id_of<Digest>(row.column_blob(kFirstBehindRecord));
    each.is_retired = row.column_integer(kFirstBehindRecord + 1) != 0;
    each.scene_bytes = count_of(row, kFirstBehindRecord + 2);
  }
  return arrived;
}

std::map<Uuid, Digest> select_known(Connection& connection, std::span<const Uuid> reports) {
  std::map<Uuid, Digest> known;
  for (const Row row :
       connection.query("SELECT report_uuid, body_sha256 FROM attempt WHERE report_uuid = ANY ($1)",
                        bytes_of(reports)))
    known.emplace(id_of<Uuid>(row.column_blob(0)), id_of<Digest>(row.column_blob(1)));
  return known;
}

Feed<ArrivedReport> feed_of_arrivals(Connection& connection, std::string_view task,
                                     std::string_view cursor, std::size_t limit) {
  const PairFilter filter{.task = task};
  std::vector<Parameter> parameters =
      next_of(parse_arrival_cursor(cursor), static_cast<std::int64_t>(limit) + 1);
  const std::string page = next_arrivals(connection, filter, parameters, std::string(kIsSettled));
  return read_feed<ArrivedReport>(
      connection.query_with(
          "SELECT attempt.arrived_in::text::bigint, attempt.id, attempt.report_uuid,"
          " attempt.body_sha256," +
              std::string(kReportIsRetired) + "FROM (" + page + std::string(kAttemptOfPage) +
              std::string(kPathOfAttempt) + "ORDER BY attempt.arrived_in, attempt.id",
          parameters),
      cursor, limit,
      [](const store::Row& row) {
        return ArrivedReport{id_of<Uuid>(row.column_blob(2)), row.column_integer(4) != 0,
                             id_of<Digest>(row.column_blob(3))};
      },
      cursor_behind);
}

Feed<Uuid> feed_of_retirements(Connection& connection, std::string_view cursor, std::size_t limit) {
  return read_feed<Uuid>(
      connection.query_with(
          // By another name: the rows are to come in the order of the column, which an index has.
          "SELECT arrived_in::text::bigint AS place, id, report_uuid FROM retired_report"
          " WHERE (arrived_in, id) > ($1::text::xid8, $2)" +
              std::string(kIsSettled) + " ORDER BY arrived_in, id LIMIT $3",
          next_of(parse_arrival_cursor(cursor), static_cast<std::int64_t>(limit) + 1)),
      cursor, limit, [](const store::Row& row) { return id_of<Uuid>(row.column_blob(2)); },
      cursor_behind);
}

}  // namespace kinship::store::postgres
