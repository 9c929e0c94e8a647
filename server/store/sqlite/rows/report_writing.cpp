#include "server/store/sqlite/rows/report_writing.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "server/store/rules/report_resolver.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/rows/attempt_rows.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"
#include "server/store/sqlite/rows/retirement.hpp"
#include "server/store/sqlite/rows/scene_rows.hpp"
#include "server/store/tables/searches.hpp"
#include "server/store/tables/tasks.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/robot_columns.hpp"

namespace kinship::store {
namespace {

/// Stands for the id of the new path, which is known when its row is written; no row has it.
constexpr std::int64_t kNewPathId = 0;

/// The answers to the rules' questions about one report, read as far as they ask.
struct ReportReading {
  BatchState state;
  ExperienceKey key;                                  ///< of its attempt, or of a new one
  ReportRows rows;                                    ///< of its UUID
  SceneRows scene;                                    ///< of the content of its scene
  std::optional<std::int64_t> earlier_scene_id = {};  ///< of the report that came before
};

/// A row that turns out to be damaged is moved to the damaged ones.
void read_earlier(Database& database, const Uuid& report_uuid, ReportReading& reading) {
  ReportRows& rows = reading.rows;
  if (rows.row)
    try {
      const auto query = database.cached(
          "SELECT body_sha256, machine, received_ms, path_id, scene_id, task_id, robot_id"
          " FROM attempt"
          " WHERE id = ? AND report_uuid = ? AND " +
          database.is_intact("attempt"));
      if (!query->bind_all(*rows.row, Bytes(report_uuid.bytes)).step())
        throw damaged_row("attempt " + std::to_string(*rows.row));
      reading.state.reports[report_uuid] = {.body = id_of<Digest>(query->column_blob(0)),
                                            .machine = std::string(query->column_text(1)),
                                            .received_ms = query->column_integer(2),
                                            .path_id = optional_integer_of(*query, 3)};
      reading.earlier_scene_id = optional_integer_of(*query, 4);
      reading.key = {query->column_integer(5), query->column_integer(6)};
    } catch (const SqliteError& error) {
      if (!error.is_damage())
        throw;
      rows.damaged.push_back(*rows.row);
    }
  if (!reading.state.reports.contains(report_uuid) && !rows.damaged.empty())
    reading.state.unreadable.insert(report_uuid);
}

/// A removed robot has to be registered again.
void read_robot(Database& database, const Digest& robot, BatchState& state) {
  const auto query = database.cached("SELECT id, dof, label FROM robot WHERE digest = ? AND " +
                                     database.is_intact("robot"));
  if (query->bind(1, Bytes(robot.bytes)).step() && !is_removed_label(query->column_text(2)))
    state.robots[robot] = {query->column_integer(0), query->column_integer(1)};
  else
    database.require_absent("robot", "digest", Parameter(robot));
}

/// \return whether all that the receipt of a report that came before vouches for can be read.
bool read_what_backs_its_receipt(Database& database, const PreparedAttempt& prepared,
                                 const ReportReading& reading, EarlierReport& earlier) {
  if (prepared.scene && reading.earlier_scene_id)
    earlier.is_scene_readable = is_scene_readable(database, *reading.earlier_scene_id);
  if (prepared.path && earlier.path_id)
    earlier.is_path_backed = is_receipt_backed(database, reading.key, *earlier.path_id);
  return earlier.is_scene_readable && earlier.is_path_backed;
}

/// Of a report with a path that may have to be written.
void read_paths(Database& database, const PreparedAttempt& prepared, std::uint64_t max_paths,
                BatchState& state, Pair& pair) {
  const Uuid& uuid = prepared.attempt.report_uuid;
  state.path_ids = {kNewPathId};
  if (!state.reports.contains(uuid) &&
      (state.unreadable.contains(uuid) || has_lost_attempts(database)))
    if (const auto retired = find_retired(database, pair.key, uuid)) {
      state.retired_paths[uuid] = *retired;
      return;
    }
  if (is_report_retired(database, uuid))
    state.retired.insert(uuid);
  const Digest& content = prepared.path->content;
  const SameContent& same = pair.contents[content] = find_same(database, pair.key, content);
  if (max_paths == 0 || pair.paths < max_paths || same.readable)
    return;
  const std::uint64_t excess = std::min(pair.paths - max_paths, kMaxDroppedAtOnce);
  pair.largest = select_largest(database, pair.key, excess + 1);
}

/// Reads the data that accept or refuse it: its robot, and an earlier report with its UUID.
ReportReading read_report(Database& database, const PreparedAttempt& prepared) {
  const Attempt& attempt = prepared.attempt;
  ReportReading reading;
  reading.rows = find_report(database, attempt.report_uuid);
  read_earlier(database, attempt.report_uuid, reading);
  read_robot(database, attempt.robot, reading.state);
  return reading;
}

/// The rest, of an acceptable one. Makes the task of a new one, and the row of its robot and task.
/// \param max_paths  of a robot and task; 0: no cap.
void read_pair(Database& database, const PreparedAttempt& prepared, std::uint64_t max_paths,
               ReportReading& reading) {
  const Attempt& attempt = prepared.attempt;
  BatchState& state = reading.state;
  const auto earlier = state.reports.find(attempt.report_uuid);
  const bool is_new = earlier == state.reports.end();
  if (is_new)
    reading.key = {ensure_task(database, attempt.task), state.robots.at(attempt.robot).id};
  Pair& pair = state.pairs[{attempt.robot, attempt.task}];
  pair.key = reading.key;
  pair.paths = ensure_experience(database, pair.key);
  if (!is_new && read_what_backs_its_receipt(database, prepared, reading, earlier->second))
    return;
  if (prepared.scene) {
    reading.scene = find_scene(database, prepared.scene->content);
    state.scenes[prepared.scene->content] = reading.scene.readable.has_value();
  }
  if (prepared.path && (is_new || !earlier->second.is_path_backed))
    read_paths(database, prepared, max_paths, state, pair);
}

/// \param read  the source of the changes; its state is not used.
void write_changes(Batch& batch, const BatchChanges& changes, const ReportReading& read,
                   std::int64_t now_ms) {
  Database& database = batch.database();
  std::optional<std::int64_t> scene_id = read.scene.readable;
  for (const auto& [content, scene] : changes.scenes)
    scene_id = insert_scene(database, *scene, now_ms, read.scene.damaged);
  std::optional<std::int64_t> new_path;
  for (const NewPath& path : changes.paths)
    new_path = insert_path(database, path, scene_id, now_ms);
  const auto row_of = [&](std::optional<std::int64_t> path) {
    return path == kNewPathId ? new_path : path;
  };
  for (const DamagedPath& path : changes.damaged)
    write_damaged(database, read.key, {path.id, row_of(path.replaced_by)});
  for (const KeptPath& path : changes.dropped)
    drop_path(database, read.key, path.id);
  for (NewAttempt attempt : changes.attempts) {
    attempt.path_id = row_of(attempt.path_id);
    const std::int64_t id = insert_attempt(database, attempt, scene_id, now_ms);
    insert_search(database, *attempt.from, attempt.key, now_ms);
    for (const std::int64_t damaged : read.rows.damaged)
      quarantine_row(database, "attempt", damaged, id);
    if (attempt.status == AttemptStatus::DuplicateContent)
      note_same_content(database, *attempt.path_id, attempt.from->attempt.report_uuid);
  }
  for (const RestoredReport& report : changes.restored)
    database.cached("UPDATE attempt SET path_id = ?, status = ? WHERE id = ?")
        ->bind_all(row_of(report.path_id), static_cast<std::int64_t>(report.status),
                   read.rows.row.value())
        .run();
  for (const auto& [key, change] : changes.pairs) {
    add_to_experience(database, key, change);
    if (change.is_changed)
      batch.paths_changed(key.task_id, key.robot_id);
  }
}

}  // namespace

Receipt write_report(Batch& batch, const PreparedAttempt& prepared, std::uint64_t max_paths) {
  Database& database = batch.database();
  const std::int64_t now = now_ms();
  ReportReading reading = read_report(database, prepared);
  if (!refusal_of(prepared, reading.state)) {
    if (prepared.is_retired)  // elsewhere, and so here before it is looked at
      retire_reports(batch, std::span(&prepared.attempt.report_uuid, 1));
    read_pair(database, prepared, max_paths, reading);
  }
  const std::array<const PreparedAttempt*, 1> attempts = {&prepared};
  BatchChanges changes = resolve_reports(attempts, std::move(reading.state), max_paths, now);
  write_changes(batch, changes, reading, now);
  return std::move(changes.receipts.front());
}

}  // namespace kinship::store
