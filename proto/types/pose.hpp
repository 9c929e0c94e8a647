#pragma once

#include <Eigen/Geometry>
#include <array>

#include "proto/types/result.hpp"

namespace kinship {

/// A pose at a boundary (file, wire, database, command line): x y z in m, quaternion x y z w.
using PoseArray = std::array<double, 7>;

PoseArray to_pose_array(const Eigen::Isometry3d& T_a_b);  ///< unit quaternion, qw >= 0

/// \return the pose, or InvalidInput if a number is not finite, a coordinate exceeds
///         kMaxPlacement_m, or the quaternion's norm differs from 1 by more than 1e-3.
///         The quaternion is normalised.
Result<Eigen::Isometry3d> from_pose_array(const PoseArray& pose);

/// The pose on a grid of 1 mm and 1 mrad, for use in a key: input that is equal up to that noise
/// (away from the edges of a cell) gives equal bytes. Rotation as rotation vector.
Eigen::Isometry3d snapped(const Eigen::Isometry3d& T_a_b);

}  // namespace kinship
