#pragma once

#include <set>
#include <string>
#include <utility>

#include "robots/collision/robot_solids.hpp"

namespace kinship::collision {

/// So many random configurations, and in how many of them two things have to touch to be called
/// always touching.
struct TouchSamples {
  int count = 0;
  int least = 0;
};

/// By these samples a robot's links are left out of its checks where no pairs are named.
inline constexpr TouchSamples kLinkSamples{.count = 200, .least = 190};

/// The links of a robot that touch wherever it goes: in at least samples.least of samples.count
/// random configurations within the limits. Seeded: equal input, equal answers.
/// \param robot  its unchecked pairs of links are left out.
LinkPairs links_always_touching(const RobotSolids::Parts& robot, const TouchSamples& samples);

/// The names of two things each that touch in the same sense among all that could: links,
/// attachments and obstacles.
/// \throws Failure(InvalidInput) as CollisionWorld's constructor says.
std::set<std::pair<std::string, std::string>> always_touching(const RobotSolids& robot,
                                                              const Surroundings& surroundings,
                                                              const TouchSamples& samples);

}  // namespace kinship::collision
