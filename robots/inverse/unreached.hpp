#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/task_axes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::inverse {

/// A joint that would have to go beyond a limit.
struct JointBeyond {
  std::size_t joint = 0;  ///< of the chain
  double value = 0;       ///< the needed value, joint units
  double limit = 0;       ///< the limit that it exceeds
};

/// Why no configuration of a chain was found for a pose. Found by searches: a statement that
/// something is in reach is certain; of the others, something nearer may exist.
struct Unreached {
  /// Limits whose widening would make the pose reachable: one joint, if one is enough.
  std::vector<JointBeyond> beyond;
  /// Remaining distance of the transfer frame from its place, m; none: the place was reached, or no
  /// place is wanted.
  std::optional<double> distance_m;
  /// Remaining angle to its orientation at its place, rad; none: its place was not reached, or no
  /// orientation is wanted.
  std::optional<double> angle_rad;
  /// The largest set of task axes with which the pose would be reached.
  std::optional<TaskAxes> axes;
};

/// Searches for the reasons. Takes as long as some hundred poses: for messages.
/// \param T_base_tip  a pose for which Solver::solve found nothing.
Unreached find_unreached(const kinematics::Chain& chain, const Eigen::Isometry3d& T_base_tip);

/// For people: "its place is in reach, its orientation is not, by 0.0001 rad; with --axes
/// x,y,z,roll,pitch it is reached". Empty if nothing is known.
std::string describe(const Unreached& unreached, const kinematics::Chain& chain);

}  // namespace kinship::inverse
