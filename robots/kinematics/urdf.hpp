#pragma once

#include <map>
#include <string>

#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::kinematics {

/// The chain of a description: parses its URDF text (untrusted) and follows it from base link to
/// tip link. Revolute, continuous, prismatic and fixed joints; joints off the chain that mimic none
/// of its joints are held at 0 clamped into their limits, or at `held_joints`; the stricter of hard
/// and soft limits holds.
/// \return the chain, or InvalidInput or TooLarge with the link, joint, value and limit named.
Result<Chain> read_chain(const RobotDescription& description);

/// Values of the joints of a description that are not on its chain and do not follow it: of joints
/// with one value, by name, joint units. \return the error of read_chain() if there is no chain.
Result<std::map<std::string, double>> held_values(const RobotDescription& description);

}  // namespace kinship::kinematics
