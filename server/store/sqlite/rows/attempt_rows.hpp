#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/store.hpp"
#include "server/store/values/prepared_attempt.hpp"

namespace kinship::store {

/// Writes one attempt, and its path and scene if they are new, into the batch. An attempt that came
/// before is Duplicate only if what the receipt vouches for can be read; what cannot be read any
/// more is set aside and written anew: Stored, or Recorded.
/// \param max_paths  of its robot and task (retention.hpp); 0: no cap.
/// \throws SqliteError; what was written by then is the caller's to undo.
Receipt insert_attempt(Batch& batch, const PreparedAttempt& prepared, std::uint64_t max_paths = 0);

/// The task's internal id; makes the task if it is missing.
std::int64_t ensure_task(Database& database, std::string_view task);

/// The rows of one report, as the index has them.
struct ReportRows {
  std::optional<std::int64_t> row;    ///< not set aside; it may turn out to be damaged
  std::vector<std::int64_t> damaged;  ///< set aside, and nothing replaced it yet
};
ReportRows find_report(Database& database, const Uuid& report_uuid);

/// An attempt without its path and scene, and their ids.
struct AttemptRow {
  Attempt attempt;
  std::int64_t task_id = 0;
  std::int64_t robot_id = 0;
  std::optional<std::int64_t> path_id;
  std::optional<std::int64_t> scene_id;
  std::int64_t received_ms = 0;
  bool is_robot_removed = false;
};
/// Without the names of its robot and task, which stand in other tables. \throws SqliteError: if
/// is_damage(), the row is damaged.
AttemptRow select_attempt(Database& database, std::int64_t id);
/// With the names. Nothing if there is none, or it lies on a damaged page.
std::optional<AttemptRow> select_named(Database& database, std::optional<std::int64_t> id);
void name_robot_and_task(Database& database, AttemptRow& row);

}  // namespace kinship::store
