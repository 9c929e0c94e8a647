#pragma once

#include <string>

#include "proto/types/robot_description.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::plots {

/// A robot as far as its description shows it, without its meshes.
struct DrawnRobot {
  models::LoadedRobot robot;
  std::string shapes;  ///< text on the known shapes
};

/// \throws Failure as kinematics::read_model and geometry::read_known_shapes.
DrawnRobot drawn_robot(const RobotDescription& description);

/// The chain, for forward kinematics in chain.js, and the solids of each link in its frame. Poses
/// in m, solids as pages/page/json_text.hpp writes them.
std::string to_json(const DrawnRobot& drawn);

}  // namespace kinship::plots
