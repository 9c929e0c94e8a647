#pragma once

#include <string>
#include <vector>

#include "proto/codec/request_size.hpp"
#include "proto/ros2/wire.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/result.hpp"

/// Messages of ROS nodes to values. Each becomes the message of Kinship's own conversation first,
/// whose codec checks it: what is refused there is refused here, with the same words.
namespace kinship::ros2 {

Uuid read_uuid(const wire::Uuid& uuid);

/// A report of one attempt, and the order of its configurations.
struct PathReport {
  ReportRequest request;
  std::vector<std::string> joint_names;  ///< of its waypoints' rows; empty: as the chain has them
};

/// An attempt that breaks a rule becomes a refused receipt of the request. Nothing is allocated for
/// a path beyond the limits.
Result<PathReport> read(const wire::PlannedPath& path);
Result<RobotDescription> read(const wire::Registration& registration);
Result<FetchRequest> read(const wire::DistributionQuery& query);

codec::RequestSize size_of(const wire::PlannedPath& path);
codec::RequestSize size_of(const wire::Registration& registration);
codec::RequestSize size_of(const wire::DistributionQuery& query);
codec::RequestSize size_of(const wire::StatusQuery& query);

/// Puts the rows of a report's path into the order of a robot's joints; rows of other joints are
/// left out.
/// \param joints  of the chain, base first.
/// \return why not: a joint that the report lacks, or names twice.
std::optional<Error> order_joints(PathReport& report, const std::vector<std::string>& joints);

}  // namespace kinship::ros2
