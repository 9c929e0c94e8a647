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
  double value = 0;       ///< where it would have to go, joint units
  double limit = 0;       ///< how far it may go
};

/// What stands between a chain and a pose that no configuration was found for. Found by searches:
/// what is said to be in reach is in reach, of the rest something nearer may exist.
struct Unreached {
  /// With these limits wider the pose would be reached: one joint if there is one that does.
  std::vector<JointBeyond> beyond;
  /// How near the transfer frame came to its place, m; none: a configuration was found, or no
  /// place is asked for.
  std::optional<double> distance_m;
  /// How near it came to its orientation at its place, rad; none: its place was not reached, or no
  /// orientation is asked for.
  std::optional<double> angle_rad;
  /// The most task axes with which the pose would be reached.
  std::optional<TaskAxes> axes;
};

/// Looks for what stands between. Takes as long as some hundred poses: for messages.
/// \param T_base_tip  as Solver::solve, which found nothing.
Unreached find_unreached(const kinematics::Chain& chain, const Eigen::Isometry3d& T_base_tip);

/// For people: "its place is in reach, its orientation is not, by 0.0001 rad; with --axes
/// x,y,z,roll,pitch it is reached". Empty if nothing is known.
std::string describe(const Unreached& unreached, const kinematics::Chain& chain);

}  // namespace kinship::inverse
