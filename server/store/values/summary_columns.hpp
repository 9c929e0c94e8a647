#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>

#include "proto/types/audit.hpp"
#include "proto/types/summaries.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/record_columns.hpp"

/// The columns that listings select, as SQL, and the summaries made from them.
namespace kinship::store {

/// How SQL tells a dropped path from others, without reading its waypoints.
inline constexpr std::string_view kIsDropped = "length(path.waypoints) = 1";

/// Before kIsDropped and record_columns().
inline constexpr std::string_view kPathSummaryColumns =
    "path.retired_ms, path.report_uuid, robot.digest, robot.label, task.name,"
    " path.waypoint_count, path.length, attempt.machine, attempt.received_ms, path.T_task_base, ";

inline constexpr int kRecordOfPathSummary = 11;

/// \param row  of kPathSummaryColumns, kIsDropped and record_columns().
template <Columns Row>
PathSummary read_path_summary(const Row& row) {
  PathSummary summary;
  summary.retired_ms = row.column_integer(0);  // NULL: 0
  summary.report_uuid = id_of<Uuid>(row.column_blob(1));
  summary.robot = id_of<Digest>(row.column_blob(2));
  summary.label = row.column_text(3);
  summary.task = row.column_text(4);
  summary.waypoints = count_of(row, 5);
  summary.length = row.column_real(6);
  summary.machine = row.column_text(7);
  summary.received_ms = row.column_integer(8);
  summary.T_task_base = pose_from_blob(row.column_blob(9));
  summary.dropped = row.column_integer(10) != 0;
  summary.record = read_record(row, kRecordOfPathSummary);
  return summary;
}

/// The last column is the id, by which distributions are listed.
inline constexpr std::string_view kDistributionSummaryColumns =
    "distribution.digest, revision, task.name, robot.digest, robot.label, profile, state, reason,"
    " components, configurations, paths, fitted_ms, distribution.id ";
inline constexpr int kIdOfDistributionSummary = 12;

template <Columns Row>
DistributionSummary read_distribution_summary(const Row& row) {
  DistributionSummary summary;
  summary.id = id_of<Digest>(row.column_blob(0));
  summary.revision = count_of(row, 1);
  summary.task = row.column_text(2);
  summary.robot = id_of<Digest>(row.column_blob(3));
  summary.label = row.column_text(4);
  summary.profile = row.column_text(5);
  summary.state = state_of(row.column_integer(6));
  summary.reason = row.column_text(7);
  summary.components = count_of(row, 8);
  summary.configurations = count_of(row, 9);
  summary.paths = count_of(row, 10);
  summary.fitted_ms = row.column_integer(11);
  return summary;
}

inline constexpr std::string_view kAuditColumns =
    "id, time_ms, name, role, client, is_local, verb, target, outcome, was, became, message ";

template <Columns Row>
AuditEntry read_audit_entry(const Row& row) {
  constexpr std::int64_t kOutcomes = 4;
  AuditEntry entry;
  entry.number = count_of(row, 0);
  entry.time_ms = row.column_integer(1);
  entry.name = row.column_text(2);
  entry.role = row.column_text(3);
  entry.client = row.column_text(4);
  entry.is_local = row.column_integer(5) != 0;
  entry.verb = row.column_text(6);
  entry.target = row.column_text(7);
  entry.outcome =
      static_cast<AuditOutcome>(std::clamp<std::int64_t>(row.column_integer(8), 1, kOutcomes) - 1);
  entry.before = row.column_text(9);
  entry.after = row.column_text(10);
  entry.message = row.column_text(11);
  return entry;
}

/// Of a robot; with its paths and attempts, and when its geometry was last replaced; 0: never.
inline constexpr std::string_view kRobotSummaryColumns =
    "digest, label, base_link, tip_link, dof, registered_ms,"
    " (SELECT CAST(coalesce(sum(paths), 0) AS bigint) FROM experience WHERE robot_id = robot.id),"
    " (SELECT CAST(coalesce(sum(attempts), 0) AS bigint) FROM experience WHERE robot_id = "
    "robot.id),"
    " (SELECT coalesce(max(taken_ms), 0) FROM robot_geometry WHERE robot_id = robot.id) ";

template <Columns Row>
RobotSummary read_robot_summary(const Row& row) {
  RobotSummary summary;
  summary.robot = id_of<Digest>(row.column_blob(0));
  summary.label = row.column_text(1);
  summary.base_link = row.column_text(2);
  summary.tip_link = row.column_text(3);
  summary.dof = static_cast<std::uint32_t>(row.column_integer(4));
  summary.registered_ms = row.column_integer(5);
  summary.paths = count_of(row, 6);
  summary.attempts = count_of(row, 7);
  summary.geometry_ms = row.column_integer(8);
  return summary;
}

/// The cost of the attempts of a sampling mode, from three columns: attempts, solved, checks.
template <Columns Row>
std::optional<ModeEvidence> read_evidence(const Row& row, int first_column) {
  if (row.column_integer(first_column) == 0)
    return std::nullopt;
  ModeEvidence mode{count_of(row, first_column), count_of(row, first_column + 1)};
  if (mode.solved > 0)
    mode.checks_per_solution = row.column_real(first_column + 2) / static_cast<double>(mode.solved);
  return mode;
}

/// From five columns: attempts, and their sums of the members of PathMeans.
template <Columns Row>
std::optional<PathMeans> read_means(const Row& row, int first_column) {
  const std::uint64_t attempts = count_of(row, first_column);
  if (attempts == 0)
    return std::nullopt;
  const auto mean = [&](int column) {
    return row.column_real(first_column + column) / static_cast<double>(attempts);
  };
  return PathMeans{attempts, mean(1), mean(2), mean(3), mean(4)};
}

/// Of an attempt: whether it counts in PathMeans, in SQL as in rules/report_resolver.
inline constexpr std::string_view kIsMeasured =
    "(outcome = 1 AND processor_time_s > 0 AND machine_speed > 0 AND hand_length_m > 0"
    " AND least_clearance_m > 0)";

/// The sums of `experience` over all robots and tasks: of guided attempts and of control ones, each
/// for read_means().
inline constexpr std::string_view kMeansOfAll =
    "SELECT CAST(coalesce(sum(guided_measured), 0) AS bigint), coalesce(sum(guided_time_s), 0),"
    " coalesce(sum(guided_length), 0), coalesce(sum(guided_hand_length_m), 0),"
    " coalesce(sum(guided_clearance_m), 0), CAST(coalesce(sum(control_measured), 0) AS bigint),"
    " coalesce(sum(control_time_s), 0), coalesce(sum(control_length), 0),"
    " coalesce(sum(control_hand_length_m), 0), coalesce(sum(control_clearance_m), 0)"
    " FROM experience";
inline constexpr int kControlMeansOfAll = 5;

/// Of a robot in a task.
inline constexpr std::string_view kTaskRobotColumns =
    "task_id, robot_id, paths, attempts, generation, dropped, guided_attempts, guided_solved,"
    " guided_checks, control_attempts, control_solved, control_checks, guided_measured,"
    " guided_time_s, guided_length, guided_hand_length_m, guided_clearance_m, control_measured,"
    " control_time_s, control_length, control_hand_length_m, control_clearance_m ";

/// \param row  of kTaskRobotColumns.
template <Columns Row>
TaskRobotSummary read_task_robot(const Row& row, const Digest& robot, std::string_view label) {
  constexpr int kGuided = 6, kControl = 9, kGuidedMeans = 12, kControlMeans = 17;
  return {robot,
          std::string(label),
          count_of(row, 2),
          count_of(row, 3),
          count_of(row, 4),
          count_of(row, 5),
          read_evidence(row, kGuided),
          read_evidence(row, kControl),
          read_means(row, kGuidedMeans),
          read_means(row, kControlMeans)};
}

/// The summary of a task from those of its robots, in order of labels.
TaskSummary summary_of(std::string_view task, std::vector<TaskRobotSummary> robots);

}  // namespace kinship::store
