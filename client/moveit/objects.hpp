#pragma once

#include "client/moveit/conversion.hpp"
#include "client/moveit/frames.hpp"
#include "client/moveit/yaml_value.hpp"

namespace kinship::moveit {

/// Reads the obstacles and attached objects of a robot into `conversion`: world and robot_state of
/// moveit_msgs/PlanningScene, start_state of moveit_msgs/MotionPlanRequest, and the pairs of
/// allowed_collision_matrix.
/// \throws Failure(InvalidInput) that names the place
void read_objects(const YamlValue& scene, const YamlValue& request, const kinematics::Chain& chain,
                  const Frames& frames, Conversion& conversion);

}  // namespace kinship::moveit
