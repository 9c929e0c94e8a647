#include "server/store/sqlite/attempt_rows.hpp"

#include <string>

#include "server/store/sqlite/clock.hpp"
#include "server/store/sqlite/path_rows.hpp"
#include "server/store/sqlite/row_values.hpp"
#include "server/store/sqlite/scene_rows.hpp"

namespace kinship::store {
namespace {

enum class AttemptStatus : std::uint8_t { Stored = 1, DuplicateContent = 2, Unsolved = 3 };

Receipt refused(const Uuid& report_uuid, const std::string& why) {
  return {report_uuid, ReceiptStatus::Refused, "attempt " + report_uuid.text() + ": " + why};
}

/// The receipt of a report that came before under the same UUID.
std::optional<Receipt> earlier_receipt(Database& database, const PreparedAttempt& prepared) {
  const Uuid& uuid = prepared.attempt.report_uuid;
  const auto query = database.cached("SELECT body_sha256 FROM attempt WHERE report_uuid = ?");
  if (!query->bind(1, Bytes(uuid.bytes)).step())
    return std::nullopt;
  if (id_of<Digest>(query->column_blob(0)) == prepared.body)
    return Receipt{uuid, ReceiptStatus::Duplicate, ""};
  return refused(uuid, "this UUID was used for another report");
}

struct RobotRow {
  std::int64_t id = 0;
  std::int64_t dof = 0;
};

std::optional<RobotRow> find_robot_row(Database& database, const Digest& robot) {
  const auto query = database.cached("SELECT id, dof FROM robot WHERE digest = ?");
  if (!query->bind(1, Bytes(robot.bytes)).step())
    return std::nullopt;
  return RobotRow{query->column_integer(0), query->column_integer(1)};
}

/// What became of an attempt's path.
struct AttemptPath {
  AttemptStatus status = AttemptStatus::Unsolved;
  std::optional<std::int64_t> id;
};

AttemptPath keep_path(Database& database, const PreparedAttempt& prepared, const ExperienceKey& key,
                      const PathArrival& arrival) {
  if (!prepared.path)
    return {};
  if (const auto same = find_path(database, key, prepared.path->content))
    return {AttemptStatus::DuplicateContent, same};
  return {AttemptStatus::Stored, insert_path(database, key, prepared, arrival)};
}

void insert_row(Database& database, const PreparedAttempt& prepared, const ExperienceKey& key,
                const AttemptPath& path, const PathArrival& arrival) {
  const Attempt& attempt = prepared.attempt;
  const PlanningRecord& record = attempt.record;
  const auto T_task_base = optional_pose_blob(attempt.T_task_base);
  std::optional<Bytes> distribution;
  if (record.distribution_id)
    distribution = Bytes(record.distribution_id->bytes);
  database
      .cached(
          "INSERT INTO attempt (report_uuid, body_sha256, task_id, robot_id, path_id, status,"
          " machine, T_task_base, outcome, planner, planner_options, planning_time_s,"
          " collision_checks, projections, time_limit_s, arm, share, distribution_digest,"
          " distribution_revision, received_ms, scene_id) "
          "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      ->bind_all(Bytes(attempt.report_uuid.bytes), Bytes(prepared.body.bytes), key.task_id,
                 key.robot_id, path.id, static_cast<std::int64_t>(path.status),
                 std::string_view(attempt.machine), blob_or_null(T_task_base),
                 code_of(record.outcome), std::string_view(record.planner),
                 std::string_view(record.planner_options), record.planning_time_s,
                 static_cast<std::int64_t>(record.collision_checks),
                 static_cast<std::int64_t>(record.projections), record.time_limit_s,
                 code_of(record.sampling_mode), record.share, distribution,
                 static_cast<std::int64_t>(record.distribution_revision), arrival.received_ms,
                 arrival.scene_id)
      .run();
}

}  // namespace

std::int64_t ensure_task(Database& database, std::string_view task) {
  {
    const auto query = database.cached("SELECT id FROM task WHERE name = ?");
    if (query->bind(1, task).step())
      return query->column_integer(0);
  }
  database.cached("INSERT INTO task (name) VALUES (?)")->bind(1, task).run();
  return database.last_insert_id();
}

Receipt insert_attempt(Batch& batch, const PreparedAttempt& prepared) {
  Database& database = batch.database();
  const Attempt& attempt = prepared.attempt;
  if (std::optional<Receipt> earlier = earlier_receipt(database, prepared))
    return *earlier;
  const std::optional<RobotRow> robot = find_robot_row(database, attempt.robot);
  if (!robot)
    return refused(attempt.report_uuid,
                   "robot " + attempt.robot.short_hex() + " is not registered");
  if (prepared.path && prepared.path->blob.dof != robot->dof)
    return refused(attempt.report_uuid, "path of " + std::to_string(prepared.path->blob.dof) +
                                            " joints, robot " + attempt.robot.short_hex() +
                                            " has " + std::to_string(robot->dof));

  const ExperienceKey key{ensure_task(database, attempt.task), robot->id};
  ensure_experience(database, key);
  PathArrival arrival{.received_ms = now_ms(), .scene_id = {}};
  if (prepared.scene)
    arrival.scene_id = ensure_scene(database, *prepared.scene, arrival.received_ms);
  const AttemptPath path = keep_path(database, prepared, key, arrival);
  insert_row(database, prepared, key, path, arrival);
  const bool stored = path.status == AttemptStatus::Stored;
  count_attempt(database, key, attempt.record, stored);
  if (stored) {
    batch.paths_changed(key.task_id, key.robot_id);
    return {attempt.report_uuid, ReceiptStatus::Stored, ""};
  }
  return {attempt.report_uuid, prepared.path ? ReceiptStatus::Duplicate : ReceiptStatus::Recorded,
          ""};
}

PlanningRecord read_record(const Statement& row, int first_column) {
  int column = first_column;
  PlanningRecord record;
  record.outcome = outcome_of(row.column_integer(column++));
  record.planner = row.column_text(column++);
  record.planner_options = row.column_text(column++);
  record.planning_time_s = row.column_real(column++);
  record.collision_checks = count_of(row, column++);
  record.projections = count_of(row, column++);
  record.time_limit_s = row.column_real(column++);
  record.sampling_mode = mode_of(row.column_integer(column++));
  record.share = row.column_real(column++);
  record.distribution_id = optional_id_of<Digest>(row, column++);
  record.distribution_revision = count_of(row, column);
  return record;
}

std::optional<AttemptRow> select_attempt(Database& database, const Uuid& report_uuid) {
  constexpr int kFirstOfRecord = 6;
  const auto query = database.cached(
      "SELECT robot.digest, task.name, attempt.machine, attempt.T_task_base, attempt.path_id,"
      " attempt.scene_id, " +
      std::string(kRecordColumns) +
      "FROM attempt JOIN robot ON robot.id = attempt.robot_id "
      "JOIN task ON task.id = attempt.task_id WHERE attempt.report_uuid = ?");
  if (!query->bind(1, Bytes(report_uuid.bytes)).step())
    return std::nullopt;
  AttemptRow row;
  row.attempt.report_uuid = report_uuid;
  row.attempt.robot = id_of<Digest>(query->column_blob(0));
  row.attempt.task = query->column_text(1);
  row.attempt.machine = query->column_text(2);
  row.attempt.T_task_base = pose_from_blob(query->column_blob(3));
  if (!query->column_is_null(4))
    row.path_id = query->column_integer(4);
  if (!query->column_is_null(5))
    row.scene_id = query->column_integer(5);
  row.attempt.record = read_record(*query, kFirstOfRecord);
  return row;
}

}  // namespace kinship::store
