#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "robots/inverse/solver.hpp"

namespace kinship::planning {

/// Poses of the transfer frame to follow, from the arm's configuration.
struct PoseTrack {
  std::vector<Eigen::Isometry3d> T_base_transfer;  ///< in the base link, n
  Eigen::VectorXd begin;                           ///< dof: puts the transfer frame at the first
  Eigen::VectorXd towards;  ///< dof: attracts the self-motion at the end of the way
};

/// A pose track as followed by an arm.
struct Track {
  Eigen::MatrixXd configurations;  ///< dof x m, 1 <= m <= n: configurations at their poses
  double gap = 0;                  ///< from the last configuration to `towards`, joint units
};

/// Follows pose tracks with an arm, each configuration from the one before, eight at a time: damped
/// least squares, joints held within their limits, drawn a little towards the straight line from
/// `begin` to `towards` within the task's freedom. Poses missed by more than 4 cm or 0.25 rad are
/// skipped.
/// Source of the step: robots/inverse/lanes.hpp.
std::vector<Track> follow(const inverse::Solver& solver, std::span<const PoseTrack> tracks);

}  // namespace kinship::planning
