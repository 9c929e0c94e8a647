#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "robots/kinematics/link_tree.hpp"

/// Joints of a URDF that are no part of an arm: of a gripper, and of a mobile base.
namespace kinship::kinematics {

/// Whether the joint above a link moves a finger or jaw rather than an arm: another joint follows
/// it, it slides less than an arm's axis does, a joint of the same kind hangs beside it, or it
/// turns to one side from closed and is named as a jaw or ends an arm of six joints.
/// \param link    index of the moving link
/// \param before  moving joints between the base and it
bool is_gripping_joint(const std::vector<TreeLink>& tree, std::size_t link, std::size_t before);

/// A sentence on each joint of a mobile base; empty for a robot that stands still.
std::vector<std::string> describe_mobile_base(const std::vector<TreeLink>& tree);

}  // namespace kinship::kinematics
