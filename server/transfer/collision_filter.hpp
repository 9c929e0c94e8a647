#pragma once

#include "robots/collision/collision_world.hpp"
#include "server/transfer/filters.hpp"

namespace kinship::transfer {

/// Keeps the configurations in which the robot touches neither itself nor its surroundings. Without
/// surroundings, a filter against self-collision; empty if the robot has no shapes. Not shared
/// between threads.
///
/// A fixed link of the robot that touches an obstacle makes every configuration collide
/// (CollisionWorld); the caller allows such pairs in the surroundings.
/// \throws Failure(InvalidInput), see CollisionWorld's constructor.
ConfigurationFilter collision_filter(const collision::RobotSolids& robot,
                                     const collision::Surroundings& surroundings = {});

/// The same answers as `exact`, sooner: it is asked where `covers` rejects a configuration alone.
/// \param covers     rejects all that touch as they do for `exact`, but for pairs of `uncovered`.
/// \param uncovered  rejects what touches of the pairs that `covers` does not compare; may be
/// empty.
ConfigurationFilter covered_filter(ConfigurationFilter exact, ConfigurationFilter covers,
                                   ConfigurationFilter uncovered);

}  // namespace kinship::transfer
