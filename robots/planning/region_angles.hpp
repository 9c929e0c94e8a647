#pragma once

#include <Eigen/Core>

#include "robots/planning/region_constraint.hpp"

/// Shared parts of the projections onto a region; for this library's sources only.
namespace kinship::planning {

inline constexpr int kMaxIterations = 12;                                     ///< of a projection
inline constexpr double kAimed = 0.5 * RegionConstraint::kWaypointTolerance;  ///< it ends there
inline constexpr double kSquaredDamping =
    1e-4;  ///< of singular values about 1 (m or rad per joint unit)
inline constexpr double kMinCosine =
    1e-3;  ///< of the pitch: its derivative is unbounded at 90 degrees

/// A rotation outside its bounds.
struct AngleExcess {
  Eigen::Vector3d beyond;  ///< roll, pitch, yaw, rad; 0 within the bounds
  bool is_flipped;         ///< whether the rotation counts as (roll + pi, pi - pitch, yaw + pi)
};

/// The excess of a rotation in the one of its two representations that is less outside, angles
/// modulo a full turn.
/// \param angles  roll, pitch, yaw, rad; arbitrary for unbounded ones.
/// \param bounds  2 x 3: lower, upper; both infinite, or less than a turn apart.
AngleExcess angle_excess(const Eigen::Vector3d& angles,
                         const Eigen::Ref<const Eigen::Matrix<double, 2, 3>>& bounds);

}  // namespace kinship::planning
