#pragma once

#include <Eigen/Core>

namespace kinship::planning {

/// The configurations to check along a path: each segment cut into the fewest equal parts of at
/// most `step`.
/// \param waypoints  dof x n, n >= 1.
/// \return           dof x m, m >= n; first and last waypoint unchanged.
/// \throws std::invalid_argument if there is no waypoint or the step is not positive.
Eigen::MatrixXd densified(const Eigen::MatrixXd& waypoints, double step);

/// The least waypoints that `densified` turns into the given ones again (within 1e-9): what was
/// checked stays what is checked, and the content does not depend on the step.
/// \param waypoints  dof x n, n >= 1, at most `step` apart; repeated ones are dropped.
Eigen::MatrixXd sparse_vertices(const Eigen::MatrixXd& waypoints, double step);

/// Length of a path, joint units.
double path_length(const Eigen::MatrixXd& waypoints);

}  // namespace kinship::planning
