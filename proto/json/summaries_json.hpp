#pragma once

#include <string>
#include <string_view>

#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"

/// The rows of the admin conversation and of `--json` listings: the server writes them, the
/// command line reads them. Member names are those of the structs and stay.
namespace kinship::json {

std::string to_json(const RobotSummary& summary);
std::string to_json(const TaskSummary& summary);
std::string to_json(const PathSummary& summary);
std::string to_json(const AttemptSummary& summary);
std::string to_json(const DistributionSummary& summary);
std::string to_json(const ServerStatus& status);

Result<RobotSummary> robot_summary_from_json(std::string_view text);
Result<TaskSummary> task_summary_from_json(std::string_view text);
Result<PathSummary> path_summary_from_json(std::string_view text);
Result<AttemptSummary> attempt_summary_from_json(std::string_view text);
Result<DistributionSummary> distribution_summary_from_json(std::string_view text);
Result<ServerStatus> server_status_from_json(std::string_view text);

}  // namespace kinship::json
