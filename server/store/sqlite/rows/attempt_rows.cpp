#include "server/store/sqlite/rows/attempt_rows.hpp"

#include <string>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/retention.hpp"
#include "server/store/sqlite/rows/retired_reports.hpp"
#include "server/store/sqlite/rows/retirement.hpp"
#include "server/store/sqlite/rows/robot_rows.hpp"
#include "server/store/sqlite/rows/scene_rows.hpp"
#include "server/store/sqlite/rows/set_aside_rows.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/receipt_texts.hpp"
#include "server/store/values/robot_columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store {
namespace {

enum class AttemptStatus : std::uint8_t { Stored = 1, DuplicateContent = 2, Unsolved = 3 };

/// What is known of a report that came before under the same UUID.
struct EarlierAttempt {
  std::int64_t id = 0;
  Digest body;
  std::optional<std::int64_t> path_id;
  std::optional<std::int64_t> scene_id;
  std::int64_t received_ms = 0;
  std::string machine = {};
};

/// Whether a report is the one that came before. Its machine may be called otherwise since: by the
/// name in a certificate that it had not then, or has not any more.
bool is_again(const PreparedAttempt& prepared, const EarlierAttempt& earlier) {
  return earlier.body == prepared.body || (earlier.machine != prepared.attempt.machine &&
                                           earlier.body == body_said_by(prepared, earlier.machine));
}

/// \param rows  of its UUID; a row that turns out to be damaged is moved to the damaged ones.
std::optional<EarlierAttempt> read_earlier(Database& database, ReportRows& rows) {
  if (!rows.row)
    return std::nullopt;
  try {
    const auto query = database.cached(
        "SELECT body_sha256, path_id, scene_id, received_ms, machine FROM attempt WHERE id = ?");
    query->bind(1, *rows.row).step();
    EarlierAttempt earlier{.id = *rows.row,
                           .body = id_of<Digest>(query->column_blob(0)),
                           .path_id = optional_integer_of(*query, 1),
                           .scene_id = optional_integer_of(*query, 2),
                           .received_ms = query->column_integer(3),
                           .machine = std::string(query->column_text(4))};
    return earlier;
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    rows.damaged.push_back(*rows.row);
    return std::nullopt;
  }
}

/// Of a robot that is registered: a removed one has to be registered again.
struct RobotRow {
  std::int64_t id = 0;
  std::int64_t dof = 0;
};

std::optional<RobotRow> find_robot_row(Database& database, const Digest& robot) {
  const auto query = database.cached("SELECT id, dof, label FROM robot WHERE digest = ?");
  if (!query->bind(1, Bytes(robot.bytes)).step() || is_removed_label(query->column_text(2)))
    return std::nullopt;
  return RobotRow{query->column_integer(0), query->column_integer(1)};
}

/// What became of an attempt's path.
struct AttemptPath {
  AttemptStatus status = AttemptStatus::Unsolved;
  std::optional<std::int64_t> id;
  bool is_retired = false;  ///< from the start: its report was retired elsewhere

  bool is_new() const { return status == AttemptStatus::Stored && id && !is_retired; }
  bool is_beyond_cap() const { return status == AttemptStatus::Stored && !id; }
};

/// What an attempt comes into.
struct AttemptPlace {
  ExperienceKey key;
  PathArrival arrival;
  std::uint64_t max_paths = 0;
};

/// \param came_before  the attempt may have been there, and its row is lost.
AttemptPath keep_path(Batch& batch, const PreparedAttempt& prepared, const AttemptPlace& place,
                      bool came_before) {
  if (!prepared.path)
    return {};
  Database& database = batch.database();
  const ExperienceKey& key = place.key;
  // What somebody retired does not come back because the row of its attempt is damaged.
  if (came_before)
    if (const auto retired = find_retired(database, key, prepared.attempt.report_uuid))
      return {AttemptStatus::DuplicateContent, retired};
  if (is_report_retired(database, prepared.attempt.report_uuid)) {
    PathArrival arrival = place.arrival;
    arrival.retired_ms = now_ms();
    return {AttemptStatus::Stored, insert_path(database, key, prepared, arrival), true};
  }
  const SameContent same = find_same(database, key, prepared.path->content);
  if (same.readable)
    return {AttemptStatus::DuplicateContent, same.readable};
  if (!is_within_cap(database, key, prepared.path->content, place.max_paths)) {
    for (const std::int64_t damaged : same.damaged)
      retire_damaged(batch, key, damaged);
    count_dropped(database, key);
    return {AttemptStatus::Stored, std::nullopt};
  }
  const std::int64_t id = insert_path(database, key, prepared, place.arrival);
  for (const std::int64_t damaged : same.damaged)
    replace_path(batch, key, damaged, id);
  return {AttemptStatus::Stored, id};
}

/// What the receipt of a report says that is new here.
Receipt receipt_of_new(const PreparedAttempt& prepared, const AttemptPath& path,
                       std::uint64_t max_paths, bool came_before) {
  const Uuid& uuid = prepared.attempt.report_uuid;
  if (path.is_new())
    return {uuid, ReceiptStatus::Stored, ""};
  if (path.is_retired)
    return {uuid, ReceiptStatus::Recorded, "recorded, but its path was retired before it came"};
  if (path.is_beyond_cap())
    return {uuid, ReceiptStatus::Recorded, beyond_cap_in_words(max_paths)};
  if (!prepared.path)
    return {uuid, ReceiptStatus::Recorded, ""};
  // A report whose row was damaged is kept anew, although its path is there.
  return {uuid, came_before ? ReceiptStatus::Stored : ReceiptStatus::Duplicate, ""};
}

/// Answers a report that came before. What it vouches for and cannot be read is written anew.
Receipt answer_again(Batch& batch, const PreparedAttempt& prepared, const AttemptPlace& place,
                     const EarlierAttempt& earlier) {
  Database& database = batch.database();
  const ExperienceKey& key = place.key;
  const Uuid& uuid = prepared.attempt.report_uuid;
  const bool has_scene =
      !prepared.scene || !earlier.scene_id || is_scene_readable(database, *earlier.scene_id);
  if (!has_scene)
    static_cast<void>(ensure_scene(database, *prepared.scene, now_ms()));
  if (!prepared.path || !earlier.path_id || is_vouched_for(database, key, *earlier.path_id))
    return {uuid,
            has_scene       ? ReceiptStatus::Duplicate
            : prepared.path ? ReceiptStatus::Stored
                            : ReceiptStatus::Recorded,
            ""};
  const AttemptPath path = keep_path(batch, prepared, place, false);
  if (path.id)
    replace_path(batch, key, *earlier.path_id, *path.id);
  else
    retire_damaged(batch, key, *earlier.path_id);
  database.cached("UPDATE attempt SET path_id = ?, status = ? WHERE id = ?")
      ->bind_all(path.id, static_cast<std::int64_t>(path.status), earlier.id)
      .run();
  if (path.is_new()) {
    count_path(database, key);
    batch.paths_changed(key.task_id, key.robot_id);
    drop_excess(batch, key, place.max_paths);
  }
  if (path.is_beyond_cap())
    return {uuid, ReceiptStatus::Recorded, beyond_cap_in_words(place.max_paths)};
  return {uuid, ReceiptStatus::Stored, ""};
}

std::int64_t insert_row(Database& database, const PreparedAttempt& prepared,
                        const ExperienceKey& key, const AttemptPath& path,
                        const PathArrival& arrival) {
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
  return database.last_insert_id();
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

Receipt insert_attempt(Batch& batch, const PreparedAttempt& prepared, std::uint64_t max_paths) {
  Database& database = batch.database();
  const Attempt& attempt = prepared.attempt;
  ReportRows rows = find_report(database, attempt.report_uuid);
  const std::optional<EarlierAttempt> earlier = read_earlier(database, rows);
  if (earlier && !is_again(prepared, *earlier))
    return refused(attempt.report_uuid, "this UUID was used for another report");
  const std::optional<RobotRow> robot = find_robot_row(database, attempt.robot);
  if (!robot)
    return {attempt.report_uuid, ReceiptStatus::UnknownRobot,
            "robot " + attempt.robot.short_hex() + " is not registered"};
  if (prepared.path && prepared.path->blob.dof != robot->dof)
    return refused(attempt.report_uuid, "path of " + std::to_string(prepared.path->blob.dof) +
                                            " joints, robot " + attempt.robot.short_hex() +
                                            " has " + std::to_string(robot->dof));

  const ExperienceKey key{ensure_task(database, attempt.task), robot->id};
  if (earlier) {
    if (prepared.is_retired)
      retire_reports(batch, std::span(&attempt.report_uuid, 1));
    return answer_again(
        batch, prepared,
        {key, {.received_ms = earlier->received_ms, .scene_id = earlier->scene_id}, max_paths},
        *earlier);
  }
  if (prepared.is_retired)
    note_retired_report(database, attempt.report_uuid);
  ensure_experience(database, key);
  PathArrival arrival{.received_ms = prepared.received_ms.value_or(now_ms()), .scene_id = {}};
  if (prepared.scene)
    arrival.scene_id = ensure_scene(database, *prepared.scene, arrival.received_ms);
  const AttemptPath path = keep_path(batch, prepared, {key, arrival, max_paths},
                                     !rows.damaged.empty() || has_orphans(database));
  const std::int64_t id = insert_row(database, prepared, key, path, arrival);
  for (const std::int64_t damaged : rows.damaged)
    put_aside(database, AsideKind::Attempt, damaged, id);
  if (path.status == AttemptStatus::DuplicateContent)
    note_same_content(database, *path.id, attempt.report_uuid);
  const bool stored = path.is_new();
  if (rows.damaged.empty())
    count_attempt(database, key, attempt.record, stored);
  else if (stored)
    count_path(database, key);  // the attempt was counted when it came first
  if (stored)
    batch.paths_changed(key.task_id, key.robot_id);
  if (path.status == AttemptStatus::Stored)
    drop_excess(batch, key, max_paths);
  return receipt_of_new(prepared, path, max_paths, !rows.damaged.empty());
}

ReportRows find_report(Database& database, const Uuid& report_uuid) {
  const auto query = database.cached(
      "SELECT id FROM attempt INDEXED BY attempt_by_uuid WHERE report_uuid = ? ORDER BY id");
  query->bind(1, Bytes(report_uuid.bytes));
  ReportRows rows;
  while (query->step()) {
    const std::int64_t id = query->column_integer(0);
    const std::optional<Aside> aside = find_aside(database, AsideKind::Attempt, id);
    if (!aside)
      rows.row = id;
    else if (!aside->replaced_by)
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
      std::string(kRecordColumns) + "FROM attempt WHERE id = ?");
  if (!query->bind(1, id).step())
    throw Failure(ErrorCode::Storage, "attempt " + std::to_string(id) + " is in an index alone");
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

std::optional<AttemptRow> select_named(Database& database, std::optional<std::int64_t> id) {
  if (!id)
    return std::nullopt;
  try {
    AttemptRow row = select_attempt(database, *id);
    name_robot_and_task(database, row);
    return row;
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    return std::nullopt;
  }
}

void name_robot_and_task(Database& database, AttemptRow& row) {
  const auto robot = database.cached("SELECT digest, label FROM robot WHERE id = ?");
  if (robot->bind(1, row.robot_id).step()) {
    row.attempt.robot = id_of<Digest>(robot->column_blob(0));
    row.is_robot_removed = is_removed_label(robot->column_text(1));
  }
  const auto task = database.cached("SELECT name FROM task WHERE id = ?");
  if (task->bind(1, row.task_id).step())
    row.attempt.task = task->column_text(0);
}

}  // namespace kinship::store
