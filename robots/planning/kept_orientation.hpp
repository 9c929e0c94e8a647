#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>

#include "proto/types/result.hpp"

namespace kinship::planning {

/// Bounds of a region's roll, pitch and yaw for an orientation that MoveIt has to be kept.
struct KeptOrientation {
  Eigen::Vector3d bounds;  ///< both ways, rad; infinite without a bound
  std::string difference;  ///< between the two, in words; empty: none

  bool bounds_any() const { return !(bounds.array() == HUGE_VAL).all(); }
};

/// moveit_msgs/OrientationConstraint bounds Rx(a) Ry(b) Rz(c) or a rotation vector, a region
/// Rz(yaw) Ry(pitch) Rx(roll). With a turn about x or z free, the region's box turns with it: the
/// other two then get bounds under which every tilt that the region allows is allowed by the
/// message. With none free all three bounds are the tolerances made smaller by one factor, under
/// which every orientation that the region allows is within them; they are at most 1.5 rad.
///
/// \param tolerances  about x, y and z, rad, not negative; pi or more is no bound.
/// \return  InvalidInput if two are free, or the turn about y alone: the message's angles then
///          bound no tilt.
Result<KeptOrientation> keep_orientation(Eigen::Vector3d tolerances, bool is_rotation_vector);

}  // namespace kinship::planning
