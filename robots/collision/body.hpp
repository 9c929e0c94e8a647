#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "robots/collision/collision_world.hpp"
#include "robots/collision/solid.hpp"

namespace kinship::collision {

enum class BodyKind { Link, Attached, Obstacle };

/// One solid of the world and what moves it.
struct Body {
  BodyKind kind = BodyKind::Link;
  std::string name;  ///< of the link, attachment or obstacle
  int link = -1;     ///< that it is or hangs on; -1 for obstacles
  int joint = -1;    ///< of the chain that moves it; -1: stands still in the base frame
  Eigen::Isometry3d T_joint_body = Eigen::Isometry3d::Identity();  ///< in the base if joint is -1
  Solid solid;
  std::vector<std::string> touch_links;  ///< of attachments
};

/// Every solid of a robot's links.
/// \throws Failure(InvalidInput) as RobotSolids' constructor says.
std::vector<Body> link_bodies(const kinematics::Chain& chain, const geometry::RobotShapes& shapes);

/// Adds attachments, then obstacles, the latter moved from the task frame into the base frame.
/// \throws Failure(InvalidInput) as CollisionWorld's constructor says.
void add_surroundings(const kinematics::Chain& chain, const Surroundings& surroundings,
                      std::vector<Body>& bodies);

}  // namespace kinship::collision
