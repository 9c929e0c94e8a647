#pragma once

#include <Eigen/Core>

#include "proto/types/path.hpp"
#include "proto/types/profile.hpp"

namespace kinship::kinematics {

/// Configurations at even distances along a path, so that its content does not depend on how
/// densely a planner wrote it. Straight between waypoints as written, also across +-pi of a
/// continuous joint; distance is Euclidean joint motion, 1 m = 1 rad.
///
/// Leaves out `dropped_end_share` of the length at each end; what remains is cut into equal
/// intervals of at most `pose_spacing`, both ends included, or into longer ones if that would
/// exceed `max_poses_per_path` (0: kMaxWaypoints). One configuration, the middle, if nothing
/// remains or only one is allowed.
/// \return dof x n, n >= 1.
/// \throws std::invalid_argument unless pose_spacing > 0, max_poses_per_path >= 0 and
///         0 <= dropped_end_share <= 0.5, or if the length of the path overflows.
Eigen::MatrixXd resample(const Path& path, const TransferParameters& parameters);

}  // namespace kinship::kinematics
