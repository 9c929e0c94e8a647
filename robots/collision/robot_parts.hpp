#pragma once

#include <vector>

#include "robots/collision/body.hpp"
#include "robots/collision/body_pairs.hpp"
#include "robots/collision/robot_solids.hpp"

/// Inside of RobotSolids; for this library's sources only.
namespace kinship::collision {

struct RobotSolids::Parts {
  kinematics::Chain chain;
  std::vector<Body> bodies;  ///< of the links
  LinkPairs unchecked;
};

/// Puts every body that a joint moves where it is at q.
/// \param T_base_bodies  one per body; those that stand still are left as they are.
void place_bodies(const kinematics::Chain& chain, const std::vector<Body>& bodies,
                  const Eigen::Ref<const Eigen::VectorXd>& q,
                  std::vector<Eigen::Isometry3d>& T_base_bodies);

/// Poses of the bodies that stand still; those that move are not placed yet.
std::vector<Eigen::Isometry3d> standing_poses(const std::vector<Body>& bodies);

}  // namespace kinship::collision
