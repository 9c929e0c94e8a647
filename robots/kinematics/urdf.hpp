#pragma once

#include <Eigen/Core>
#include <map>
#include <string>

#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/kinematics/urdf_model.hpp"

namespace kinship::kinematics {

/// A robot as its description says it, with the URDF parsed. Made by read_model(); of its
/// description, what neither the chain nor the URDF depends on may change.
struct RobotModel {
  RobotDescription description;
  UrdfModel urdf;  ///< of the description's text
  Chain chain;
};

/// Parses the URDF text (untrusted) of a description and follows it from base link to tip link.
/// Revolute, continuous, prismatic and fixed joints; joints off the chain that mimic none of its
/// joints are held at 0 clamped into their limits, or at `held_joints`; the stricter of hard and
/// soft limits holds.
/// \param parsed  of the same text, if it was parsed before.
/// \return InvalidInput or TooLarge with the link, joint, value and limit named, if no chain.
Result<RobotModel> read_model(RobotDescription description, UrdfModel parsed = {});

/// The chain alone.
Result<Chain> read_chain(const RobotDescription& description);

/// Values of the joints of a robot that are not on its chain and do not follow it: of joints with
/// one value, by name, joint units.
std::map<std::string, double> held_values(const RobotModel& robot);

/// Highest speeds of a chain's joints in its URDF: dof, joint units per second; 0 where it has
/// none.
Eigen::VectorXd velocity_limits(const RobotModel& robot);

/// The robot's name in its URDF.
std::string name_in_urdf(const RobotModel& robot);

}  // namespace kinship::kinematics
