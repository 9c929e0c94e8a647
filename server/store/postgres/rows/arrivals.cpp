#include "server/store/postgres/rows/arrivals.hpp"

#include <charconv>

#include "server/store/values/pages.hpp"
#include "server/store/values/robot_columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store::postgres {
namespace {

/// Of an attempt, its robot and task, and its path or what replaced that one.
constexpr std::string_view kArrivedColumns =
    "SELECT attempt.arrived_in::text::bigint, attempt.id,"
    " attempt.arrived_in < pg_snapshot_xmin(pg_current_snapshot()), attempt.report_uuid,"
    " robot.digest, attempt.machine, task.name, attempt.T_task_base, robot.label,"
    " attempt.received_ms, path.id, path.retired_ms IS NULL AND path.damaged_ms IS NULL,"
    " 8 * path.dof * path.waypoint_count, attempt.scene_id, ";
constexpr int kFirstOfRecord = 14;

constexpr std::string_view kArrivedTables =
    "JOIN robot ON robot.id = attempt.robot_id JOIN task ON task.id = attempt.task_id "
    "LEFT JOIN path AS named ON named.id = attempt.path_id "
    "LEFT JOIN path ON path.id = coalesce(named.replaced_by, named.id) ";

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
std::string next_arrivals(const PairFilter& filter, Parameters& parameters) {
  const std::string next =
      "(arrived_in, id) > ($1::text::xid8, $2) ORDER BY arrived_in, id LIMIT $3";
  if (filter.is_empty())
    return "SELECT id FROM attempt WHERE " + next;
  return "SELECT next.id FROM experience CROSS JOIN LATERAL (SELECT arrived_in, id FROM attempt "
         "WHERE task_id = experience.task_id AND robot_id = experience.robot_id AND " +
         next + ") AS next WHERE TRUE" + filter.condition("experience", parameters) +
         " ORDER BY next.arrived_in, next.id LIMIT $3";
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

std::vector<ArrivedAttempt> select_arrived(Connection& connection, const PairFilter& filter,
                                           const Arrival& after, std::int64_t count) {
  Parameters parameters(after.transaction, after.id, count);
  const std::string page = next_arrivals(filter, parameters);
  const Rows rows =
      connection.query(std::string(kArrivedColumns) + std::string(kRecordColumns) + "FROM (" +
                           page + ") AS page JOIN attempt ON attempt.id = page.id " +
                           std::string(kArrivedTables) + "ORDER BY attempt.arrived_in, attempt.id",
                       parameters);
  std::vector<ArrivedAttempt> arrived;
  for (const Row row : rows)
    arrived.push_back(read_arrived(row));
  return arrived;
}

std::optional<ArrivedAttempt> select_arrived(Connection& connection, const Uuid& report_uuid) {
  const Rows rows =
      connection.query(std::string(kArrivedColumns) + std::string(kRecordColumns) +
                           "FROM attempt " + std::string(kArrivedTables) + "WHERE report_uuid = $1",
                       Bytes(report_uuid.bytes));
  if (rows.empty())
    return std::nullopt;
  return read_arrived(rows.front());
}

}  // namespace kinship::store::postgres
