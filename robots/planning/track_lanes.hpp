#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "robots/inverse/solver.hpp"

namespace kinship::planning {

/// One thing to follow: poses of the transfer frame, from where the arm is on.
struct PoseTrack {
  std::vector<Eigen::Isometry3d> T_base_transfer;  ///< in the base link, n
  Eigen::VectorXd begin;                           ///< dof: puts the transfer frame at the first
  Eigen::VectorXd towards;  ///< dof: what the self-motion is drawn to at the end of the way
};

/// What an arm makes of a pose track.
struct Track {
  Eigen::MatrixXd configurations;  ///< dof x m, 1 <= m <= n: those that keep to their poses
  double gap = 0;                  ///< from the last configuration to `towards`, joint units
};

/// Follows pose tracks with an arm, each configuration from the one before, eight at a time:
/// damped least squares, joints held within their limits, drawn by a little towards the straight
/// line from `begin` to `towards` where the task leaves room. Poses that are missed by more than
/// 4 cm or 0.25 rad are passed by.
/// Source of the step: robots/inverse/lanes.hpp.
std::vector<Track> follow(const inverse::Solver& solver, std::span<const PoseTrack> tracks);

}  // namespace kinship::planning
