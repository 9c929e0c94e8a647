#pragma once

#include <optional>

#include "proto/types/attempt.hpp"
#include "proto/types/failure.hpp"
#include "server/runtime/robot_registry.hpp"

namespace kinship::service {

/// How far a waypoint may lie outside a joint limit, joint units: rounding of a client, no more.
inline constexpr double kLimitTolerance = 1e-6;

/// What is wrong with an attempt of this robot, or nothing if it may be stored. The first thing
/// found is named with its value and limit; joints and waypoints count from 1.
std::optional<Error> check_attempt(const Attempt& attempt, const runtime::Robot& robot);

}  // namespace kinship::service
