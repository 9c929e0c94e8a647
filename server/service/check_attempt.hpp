#pragma once

#include <optional>

#include "proto/types/attempt.hpp"
#include "proto/types/failure.hpp"
#include "server/runtime/robot_registry.hpp"

namespace kinship::service {

/// How far a waypoint may lie outside a joint limit, joint units: rounding of a client, no more.
inline constexpr double kLimitTolerance = 1e-6;

/// What makes an attempt without a fault (find_fault(), where it came in) none of this robot, or
/// nothing: a path of other joints, or outside their limits. The first thing found is named with
/// its value and limit; joints and waypoints count from 1.
std::optional<Error> check_attempt(const Attempt& attempt, const runtime::Robot& robot);

}  // namespace kinship::service
