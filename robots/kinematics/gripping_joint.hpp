#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "robots/kinematics/link_tree.hpp"

/// What of a URDF's joints is no part of an arm: a gripper's, and a mobile base's.
namespace kinship::kinematics {

/// Whether the joint above a link moves a finger or jaw rather than an arm: another joint follows
/// it, it slides less than an arm's axis does, a joint of the same kind hangs beside it, or it
/// turns to one side from closed and is named as a jaw or ends an arm of six joints. \param link
/// index of the moving link \param before  moving joints between the base and it
bool is_gripping_joint(const std::vector<TreeLink>& tree, std::size_t link, std::size_t before);

/// What carries a robot about, a sentence each; empty for one that stands still.
std::vector<std::string> describe_mobile_base(const std::vector<TreeLink>& tree);

}  // namespace kinship::kinematics
