#pragma once

#include <set>
#include <string>
#include <utility>

#include "robots/collision/robot_solids.hpp"

namespace kinship::collision {

/// Number of random configurations, and in how many of them two bodies must touch to count as
/// always touching.
struct TouchSamples {
  int count = 0;
  int least = 0;
};

/// The samples by which a robot's links are excluded from checks if no pairs are named.
inline constexpr TouchSamples kLinkSamples{.count = 200, .least = 190};

/// The pairs of a robot's links that always touch: in at least samples.least of samples.count
/// random configurations within the limits. Seeded: equal input, equal answers.
/// \param robot  its unchecked pairs of links are left out.
LinkPairs links_always_touching(const RobotSolids::Parts& robot, const TouchSamples& samples);

/// The pairs of names that always touch in the same sense, among links, attachments and obstacles.
/// \throws Failure(InvalidInput) as CollisionWorld's constructor.
std::set<std::pair<std::string, std::string>> always_touching(const RobotSolids& robot,
                                                              const Surroundings& surroundings,
                                                              const TouchSamples& samples);

}  // namespace kinship::collision
