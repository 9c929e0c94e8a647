#pragma once

#include <optional>

#include "proto/types/attempt.hpp"
#include "proto/types/failure.hpp"
#include "server/runtime/robot_registry.hpp"

namespace kinship::service {

/// Distance by which a waypoint may exceed a joint limit, joint units: for a client's rounding
/// only.
inline constexpr double kLimitTolerance = 1e-6;

/// Why a valid attempt (validate(Attempt) on arrival) does not fit this robot, or nothing:
/// its path has another number of joints, or lies outside their limits. The error names the first
/// violation with its value and limit; joints and waypoints count from 1.
std::optional<Error> validate(const Attempt& attempt, const runtime::Robot& robot);

}  // namespace kinship::service
