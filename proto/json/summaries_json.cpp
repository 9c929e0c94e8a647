#include "proto/json/summaries_json.hpp"

#include "proto/json/fields.hpp"

namespace kinship::json {

std::string to_json(const RobotSummary& summary) { return write_fields(summary); }
std::string to_json(const TaskSummary& summary) { return write_fields(summary); }
std::string to_json(const PathSummary& summary) { return write_fields(summary); }
std::string to_json(const AttemptSummary& summary) { return write_fields(summary); }
std::string to_json(const DistributionSummary& summary) { return write_fields(summary); }
std::string to_json(const ServerStatus& status) { return write_fields(status); }

Result<RobotSummary> robot_summary_from_json(std::string_view text) {
  return read_fields<RobotSummary>(text, "robot");
}

Result<TaskSummary> task_summary_from_json(std::string_view text) {
  return read_fields<TaskSummary>(text, "task");
}

Result<PathSummary> path_summary_from_json(std::string_view text) {
  return read_fields<PathSummary>(text, "path");
}

Result<AttemptSummary> attempt_summary_from_json(std::string_view text) {
  return read_fields<AttemptSummary>(text, "attempt");
}

Result<DistributionSummary> distribution_summary_from_json(std::string_view text) {
  return read_fields<DistributionSummary>(text, "distribution");
}

Result<ServerStatus> server_status_from_json(std::string_view text) {
  return read_fields<ServerStatus>(text, "status");
}

}  // namespace kinship::json
