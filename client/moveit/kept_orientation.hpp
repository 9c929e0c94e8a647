#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/moveit/frames.hpp"
#include "client/moveit/yaml_value.hpp"
#include "proto/types/task_space_region.hpp"

namespace kinship::moveit {

/// moveit_msgs/OrientationConstraint along a path as a region, by planning::keep_orientation.
///
/// \param left_out  receives the differences.
/// \return          empty if nothing is bounded.
/// \throws Failure(InvalidInput) at the constraint if its tolerances bound no tilt.
std::optional<TaskSpaceRegion> read_kept_orientation(const YamlValue& constraint,
                                                     const Frames& frames,
                                                     std::vector<std::string>& left_out);

}  // namespace kinship::moveit
