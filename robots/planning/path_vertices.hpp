#pragma once

#include <Eigen/Core>

#include "robots/kinematics/chain.hpp"

namespace kinship::planning {

/// Number of equal parts of at most `step` that a distance is cut into.
Eigen::Index count_of_parts(double distance, double step);

/// The configurations to check along a path: each segment cut into the fewest equal parts of at
/// most `step`.
/// \param waypoints  dof x n, n >= 1.
/// \return           dof x m, m >= n; first and last waypoint unchanged.
/// \throws std::invalid_argument if there is no waypoint or the step is not positive.
Eigen::MatrixXd densified(const Eigen::MatrixXd& waypoints, double step);

/// The fewest waypoints that `densified` turns into the given ones again (within 1e-9): the checked
/// configurations stay the same, and the content does not depend on the step.
/// \param waypoints  dof x n, n >= 1, at most `step` apart; repeated ones are dropped.
Eigen::MatrixXd sparse_vertices(const Eigen::MatrixXd& waypoints, double step);

/// Enumerates the configurations between the ends of a line, the middle first, then the middles of
/// the halves, and so on: obstacles are found early.
class MiddlesFirst {
 public:
  /// \param parts  of the line: its ends are 0 and `parts`.
  explicit MiddlesFirst(Eigen::Index parts);

  /// \return 1 to parts - 1, each once; then 0.
  Eigen::Index next();

 private:
  Eigen::Index parts_, stride_ = 1, next_ = 0;
};

/// The columns of a line but its ends, the middle first.
Eigen::MatrixXd middles_first(const Eigen::MatrixXd& line);

/// Length of a path, joint units.
double path_length(const Eigen::Ref<const Eigen::MatrixXd>& waypoints);

/// Steps in which a path is measured, joint units.
inline constexpr double kMeasuredStep = 0.05;

/// Length of the way of the transfer frame along a path, m, in chords of kMeasuredStep.
/// \param waypoints  dof x n, n >= 1
double hand_length_m(const kinematics::Chain& chain, const Eigen::MatrixXd& waypoints);

}  // namespace kinship::planning
