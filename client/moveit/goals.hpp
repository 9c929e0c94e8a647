#pragma once

#include "client/moveit/conversion.hpp"
#include "client/moveit/frames.hpp"
#include "client/moveit/yaml_value.hpp"

namespace kinship::moveit {

/// The configuration in which a robot starts: the request's start state, and the scene's robot
/// state for joints that it does not name.
/// \return dof, joint units
/// \throws Failure(InvalidInput) that names the first joint without a value
/// \param left_out  receives texts on joints that are not the chain's.
Eigen::VectorXd read_start(const YamlValue& scene, const YamlValue& request,
                           const kinematics::Chain& chain, std::vector<std::string>& left_out);

/// goal_constraints and path_constraints of moveit_msgs/MotionPlanRequest, into `conversion`.
/// \throws Failure(InvalidInput) that names the place
void read_goals(const YamlValue& request, const kinematics::Chain& chain, const Frames& frames,
                Conversion& conversion);

/// The region that path_constraints of moveit_msgs/MotionPlanRequest bound; empty if none.
/// \param left_out  receives the differences.
/// \throws Failure(InvalidInput) that names a constraint of another kind, or
///         trajectory_constraints.
std::optional<TaskSpaceRegion> read_constraint(const YamlValue& request, const Frames& frames,
                                               std::vector<std::string>& left_out);

}  // namespace kinship::moveit
