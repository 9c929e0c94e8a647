#pragma once

#include <optional>
#include <string_view>

#include "server/store/sqlite/database.hpp"
#include "server/store/sqlite/prepared_attempt.hpp"
#include "server/store/sqlite/writer.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// Writes one attempt, and its path and scene if they are new, into the batch.
/// \throws SqliteError; what was written by then is the caller's to undo.
Receipt insert_attempt(Batch& batch, const PreparedAttempt& prepared);

/// The task's internal id; makes the task if it is missing.
std::int64_t ensure_task(Database& database, std::string_view task);

/// An attempt without its path and scene, and their ids.
struct AttemptRow {
  Attempt attempt;
  std::optional<std::int64_t> path_id;
  std::optional<std::int64_t> scene_id;
};
std::optional<AttemptRow> select_attempt(Database& database, const Uuid& report_uuid);

/// The columns of a planning record in the order in which read_record() takes them.
inline constexpr std::string_view kRecordColumns =
    "attempt.outcome, attempt.planner, attempt.planner_options, attempt.planning_time_s,"
    " attempt.collision_checks, attempt.projections, attempt.time_limit_s, attempt.arm,"
    " attempt.share, attempt.distribution_digest, attempt.distribution_revision ";
PlanningRecord read_record(const Statement& row, int first_column);

}  // namespace kinship::store
