#pragma once

#include <Eigen/Geometry>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/scene.hpp"
#include "robots/collision/solid.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::collision {

/// The surroundings of a robot: scene and attached objects, and pairs of names that may touch.
struct Surroundings {
  Eigen::Isometry3d T_task_base = Eigen::Isometry3d::Identity();
  Scene scene;  ///< in the task frame
  std::vector<AttachedObject> attached;
  std::vector<std::pair<std::string, std::string>> allowed_collisions;
  bool checks_links = true;  ///< false: contacts between links are not checked
};

enum class BodyKind { Link, Attached, Obstacle };

/// One solid of the world and the joint that moves it.
struct Body {
  BodyKind kind = BodyKind::Link;
  std::string name;  ///< of the link, attachment or obstacle
  int link = -1;     ///< the link that it is or hangs on; -1 for obstacles
  int joint = -1;    ///< the moving joint that moves it; -1: stands still in the base frame
  Eigen::Isometry3d T_joint_body = Eigen::Isometry3d::Identity();  ///< in the base if joint is -1
  Solid solid;
  std::vector<std::string> touch_links;  ///< of attachments
};

/// Every solid of a robot's links.
/// \throws Failure(InvalidInput) as RobotSolids' constructor.
std::vector<Body> link_bodies(const kinematics::Chain& chain, const geometry::RobotShapes& shapes);

/// Computes the poses at q of every body that a joint moves.
/// \param T_base_bodies  one per body; those that stand still do not change.
void place_bodies(const kinematics::Chain& chain, const std::vector<Body>& bodies,
                  const Eigen::Ref<const Eigen::VectorXd>& q,
                  std::vector<Eigen::Isometry3d>& T_base_bodies);

/// Poses of the bodies that stand still; those that move are not placed yet.
std::vector<Eigen::Isometry3d> standing_poses(const std::vector<Body>& bodies);

/// Adds attachments, then obstacles, the latter moved from the task frame into the base frame.
/// \throws Failure(InvalidInput) as CollisionWorld's constructor.
void add_surroundings(const kinematics::Chain& chain, const Surroundings& surroundings,
                      std::vector<Body>& bodies);

using BodyPair = std::pair<std::size_t, std::size_t>;  ///< indices into the bodies

using LinkPairs = std::set<std::pair<int, int>>;  ///< of link indices, first < second

/// Pairs of links that have shapes, are joined by one moving joint, and have no other link with a
/// shape between them in the kinematic tree: they meet at that joint.
/// \param has_shape  one entry per link of chain.links().
/// \return           link indices, first < second, sorted.
std::vector<std::pair<int, int>> neighbouring_links(const kinematics::Chain& chain,
                                                    const std::vector<bool>& has_shape);

/// Neighbouring links with shapes, and the shapes' never-colliding ones.
LinkPairs unchecked_links(const std::vector<Body>& bodies, const kinematics::Chain& chain,
                          const geometry::RobotShapes& shapes);

/// The pairs of links' bodies that a configuration can bring together or apart, ascending.
std::vector<BodyPair> checked_links(const std::vector<Body>& links, const LinkPairs& unchecked);

/// The pairs of bodies that a configuration can bring together or apart and that may not touch.
/// Those of the last joints come first: they move most and collide most.
/// \param bodies  those of links first.
/// \param links   of these, see checked_links().
std::vector<BodyPair> moving_pairs(const std::vector<Body>& bodies,
                                   const std::vector<BodyPair>& links,
                                   const Surroundings& surroundings);

/// The pairs of a standing part of the robot and an obstacle that may not touch.
std::vector<BodyPair> standing_pairs(const std::vector<Body>& bodies,
                                     const Surroundings& surroundings);

}  // namespace kinship::collision
