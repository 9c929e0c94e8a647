#include "server/store/sqlite/rows/attempt_rows.hpp"

#include <string>
#include <vector>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/record_columns.hpp"
#include "server/store/values/robot_columns.hpp"

namespace kinship::store {
namespace {

/// As they are bound; those of the record come last.
std::vector<std::string> all_columns() {
  std::vector<std::string> columns = {"id",          "report_uuid", "body_sha256", "task_id",
                                      "robot_id",    "path_id",     "status",      "machine",
                                      "T_task_base", "received_ms", "scene_id"};
  for_each_field<PlanningRecord>(
      [&](const auto& field) { columns.emplace_back(column_of(field.name)); });
  return columns;
}

}  // namespace

std::int64_t insert_attempt(Database& database, const NewAttempt& added,
                            std::optional<std::int64_t> scene_id, std::int64_t now_ms) {
  static const std::vector<std::string> columns = all_columns();
  const Attempt& attempt = added.from->attempt;
  const auto T_task_base = optional_pose_blob(attempt.T_task_base);
  const std::int64_t id =
      database.query("SELECT coalesce(max(id), 0) + 1 FROM attempt").front().column_integer(0);
  const auto statement = database.insert_into("attempt", columns);
  statement->bind_all(id, Bytes(attempt.report_uuid.bytes), Bytes(added.from->body.bytes),
                      added.key.task_id, added.key.robot_id, added.path_id,
                      static_cast<std::int64_t>(added.status), std::string_view(attempt.machine),
                      blob_or_null(T_task_base), added.from->received_ms.value_or(now_ms),
                      scene_id);
  auto place = static_cast<int>(columns.size()) - kRecordColumns;
  for_each_field<PlanningRecord>([&](const auto& field) {
    statement->bind(++place, column_value(attempt.record.*field.member));
  });
  statement->run();
  return database.inserted_id();
}

ReportRows find_report(Database& database, const Uuid& report_uuid) {
  const auto query = database.cached(
      "SELECT id FROM attempt INDEXED BY attempt_by_uuid WHERE report_uuid = ? ORDER BY id");
  query->bind(1, Bytes(report_uuid.bytes));
  ReportRows rows;
  while (query->step()) {
    const std::int64_t id = query->column_integer(0);
    const std::optional<QuarantinedRow> quarantined = find_quarantined(database, "attempt", id);
    if (!quarantined)
      rows.row = id;
    else if (!quarantined->replaced_by)
      rows.damaged.push_back(id);
  }
  return rows;
}

AttemptRow select_attempt(Database& database, std::int64_t id) {
  constexpr int kFirstOfRecord = 8;
  AttemptRow row;
  const auto query = database.cached(
      "SELECT report_uuid, robot_id, task_id, machine, T_task_base, path_id, scene_id, "
      "received_ms, " +
      record_columns() + "FROM attempt WHERE id = ? AND " + database.is_intact("attempt"));
  if (!query->bind(1, id).step())
    throw damaged_row("attempt " + std::to_string(id));
  row.attempt.report_uuid = id_of<Uuid>(query->column_blob(0));
  row.robot_id = query->column_integer(1);
  row.task_id = query->column_integer(2);
  row.attempt.machine = query->column_text(3);
  row.attempt.T_task_base = pose_from_blob(query->column_blob(4));
  row.path_id = optional_integer_of(*query, 5);
  row.scene_id = optional_integer_of(*query, 6);
  row.received_ms = query->column_integer(7);
  row.attempt.record = read_record(*query, kFirstOfRecord);
  return row;
}

std::optional<AttemptRow> select_named(Database& database, std::optional<std::int64_t> id,
                                       std::vector<std::int64_t>& damaged) {
  if (!id)
    return std::nullopt;
  try {
    AttemptRow row = select_attempt(database, *id);
    name_robot_and_task(database, row);
    return row;
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    if (error.is_of_row())
      damaged.push_back(*id);
    return std::nullopt;
  }
}

void name_robot_and_task(Database& database, AttemptRow& row) {
  const auto robot = database.cached("SELECT digest, label FROM robot WHERE id = ? AND " +
                                     database.is_intact("robot"));
  RobotName name;
  if (robot->bind(1, row.robot_id).step())
    name = {id_of<Digest>(robot->column_blob(0)), std::string(robot->column_text(1))};
  else
    name = select_robot_names(database)[row.robot_id];
  row.attempt.robot = name.digest;
  row.is_robot_removed = is_removed_label(name.label);
  const auto task =
      database.cached("SELECT name FROM task WHERE id = ? AND " + database.is_intact("task"));
  if (!task->bind(1, row.task_id).step())
    throw damaged_row("task " + std::to_string(row.task_id));
  row.attempt.task = task->column_text(0);
}

}  // namespace kinship::store
