#pragma once

#include <set>
#include <utility>
#include <vector>

#include "robots/collision/body.hpp"

namespace kinship::collision {

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

/// The pairs of bodies that a configuration can bring together or apart and that may not touch.
/// Those of the last joints come first: they move most and collide most.
/// \param unchecked  of links.
std::vector<BodyPair> moving_pairs(const std::vector<Body>& bodies, const LinkPairs& unchecked,
                                   const Surroundings& surroundings);

/// The pairs of a standing part of the robot and an obstacle that may not touch.
std::vector<BodyPair> standing_pairs(const std::vector<Body>& bodies,
                                     const Surroundings& surroundings);

}  // namespace kinship::collision
