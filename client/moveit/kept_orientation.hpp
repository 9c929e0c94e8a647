#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/moveit/frames.hpp"
#include "client/moveit/yaml_value.hpp"
#include "proto/types/task_space_region.hpp"

namespace kinship::moveit {

/// moveit_msgs/OrientationConstraint along a path as a region. A tolerance of half a turn or more
/// is no bound.
///
/// The message bounds Rx(a) Ry(b) Rz(c) or a rotation vector, a region Rz(yaw) Ry(pitch) Rx(roll).
/// With a turn about x or z free, the region's box turns with it: the other two then get bounds
/// under which every tilt that the region allows is allowed by the message. With none free the
/// orders differ by the product of two tolerances, which `left_out` reports.
///
/// \param left_out  receives the differences.
/// \return          empty if nothing is bounded.
/// \throws Failure(InvalidInput) at the constraint if more is free, or the turn about y alone: the
///         message's angles then bound no tilt.
std::optional<TaskSpaceRegion> read_kept_orientation(const YamlValue& constraint,
                                                     const Frames& frames,
                                                     std::vector<std::string>& left_out);

}  // namespace kinship::moveit
