#pragma once

#include <utility>
#include <vector>

#include "robots/collision/body.hpp"

namespace kinship::collision {

using BodyPair = std::pair<std::size_t, std::size_t>;  ///< indices into the bodies

/// The pairs of bodies that a configuration can bring together or apart and that may not touch,
/// before links that always touch are left out. Those of the last joints come first: they move
/// most and collide most.
std::vector<BodyPair> moving_pairs(const std::vector<Body>& bodies, const kinematics::Chain& chain,
                                   const geometry::RobotShapes& shapes,
                                   const Surroundings& surroundings);

/// The pairs of a standing part of the robot and an obstacle that may not touch.
std::vector<BodyPair> standing_pairs(const std::vector<Body>& bodies,
                                     const Surroundings& surroundings);

}  // namespace kinship::collision
