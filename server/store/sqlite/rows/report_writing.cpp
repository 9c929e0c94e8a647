#include "server/store/sqlite/rows/report_writing.hpp"

#include <array>
#include <optional>
#include <span>
#include <utility>

#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/report_reading.hpp"
#include "server/store/sqlite/rows/retired_reports.hpp"
#include "server/store/sqlite/rows/retirement.hpp"
#include "server/store/sqlite/rows/set_aside_rows.hpp"
#include "server/store/values/clock.hpp"

namespace kinship::store {
namespace {

/// \param read  what the changes were resolved from; its state is not used.
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
    for (const std::int64_t damaged : read.rows.damaged)
      put_aside(database, AsideKind::Attempt, damaged, id);
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
