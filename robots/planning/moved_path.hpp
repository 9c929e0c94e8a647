#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "proto/types/task_experience.hpp"

namespace kinship::planning {

/// Start and goal of a query, as poses of the transfer frame in the task frame.
struct PoseQuery {
  Eigen::Isometry3d T_task_start;
  Eigen::Isometry3d T_task_goal;
};

/// Distance of two poses, m: a radian counts as 0.3 m.
double pose_distance_m(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

/// The paths nearest to a query, by the sum of the distances of their start and goal poses.
/// \return indices into `paths`, the nearest first, at most `count`.
std::vector<std::size_t> nearest_paths(const std::vector<PosePath>& paths, const PoseQuery& query,
                                       std::size_t count);

/// The path moved onto the query: its start to the query's start, its goal to the query's goal. The
/// first half blends from one motion to the other, the second half is moved with the goal alone, as
/// the way around a goal is mostly narrower than that around a start. Rotations by normalised
/// linear interpolation.
/// \return as many poses as the path has; the first and last are those of the query.
std::vector<Eigen::Isometry3d> moved_onto(const PosePath& path, const PoseQuery& query);

/// A path without experience: the hand moves straight to the pose `distance_m` before its goal,
/// against the z axis of the transfer frame, which points out of the palm, and from there straight
/// to the goal. With 0 it moves straight all the way.
PosePath retreat(double distance_m);

}  // namespace kinship::planning
