#pragma once

#include "robots/collision/collision_world.hpp"
#include "server/transfer/filters.hpp"

namespace kinship::transfer {

/// Keeps the configurations of a robot that touch nothing: neither the robot itself nor what
/// surrounds it. Without surroundings, a filter against self-collision; empty if the robot has no
/// shapes. Not shared between threads.
///
/// A standing part of the robot that touches an obstacle makes every configuration collide
/// (CollisionWorld); who gives a scene allows such pairs.
/// \throws Failure(InvalidInput) as CollisionWorld's constructor says.
ConfigurationFilter collision_filter(const collision::RobotSolids& robot,
                                     const collision::Surroundings& surroundings = {});

}  // namespace kinship::transfer
