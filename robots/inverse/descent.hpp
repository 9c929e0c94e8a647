#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "proto/types/limits.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::inverse {

/// A configuration with storage on the stack.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, static_cast<int>(kMaxDof), 1>;

/// Error of a pose in the task axes: x, y, z (m), then 2 sin(angle / 2) times the rotation axis;
/// expressed in the base link; zero where an axis does not matter.
using TaskError = Eigen::Matrix<double, 6, 1>;

/// From an actual to a wanted pose of the transfer frame, both in the base link. Without the yaw
/// row, for example, the error vanishes exactly if the poses differ only by a rotation about the
/// base's z axis.
TaskError task_error(const Eigen::Isometry3d& T_base_wanted, const Eigen::Isometry3d& T_base_actual,
                     const TaskAxes& axes);

/// Largest pose error of a solution, m and rad.
inline constexpr double kPoseTolerance = 1e-6;

/// Whether the chain's forward kinematics put the transfer frame at the pose, in the task axes that
/// matter, within kPoseTolerance.
bool reaches(const kinematics::Chain& chain, const Eigen::Isometry3d& T_base_transfer,
             const Eigen::Ref<const Eigen::VectorXd>& q);

/// Damped Levenberg-Marquardt descent of one chain towards poses of its transfer frame: no heap, no
/// state between calls, may be shared by threads. The damping grows with the squared error.
/// Source: Sugihara, Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method,
/// IEEE T-RO 27 (2011), eq. 14, 23.
class Descent {
 public:
  explicit Descent(const kinematics::Chain& chain);

  /// Steer: joints outside their limits are pulled towards mid-range within the chain's redundancy
  /// (none: no effect). Hold: no joint leaves its limits, given a start within them; one that would
  /// be pushed across stays there, and the others compensate. Joints with a full turn of room need
  /// neither: a turn brings them back.
  enum class Limits { Steer, Ignore, Hold };

  /// Moves `q` towards the pose, in at most `max_iterations` steps. It may end outside the limits
  /// unless they are held.
  /// \return the squared norm of the remaining task error.
  double run(const Eigen::Isometry3d& T_base_transfer, Limits limits, int max_iterations,
             JointVector& q) const;

 private:
  using TaskJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, static_cast<int>(kMaxDof)>;

  /// A joint whose axis was turned into z: constant pose in the frame before, then the motion.
  struct Step {
    Eigen::Matrix3d R;
    Eigen::Vector3d p;
    bool prismatic = false;
    bool bounded = false;  ///< has less than a turn of room
    double lower = 0, upper = 0;
  };

  TaskError error_and_jacobian(const Eigen::Isometry3d& T_base_transfer, const JointVector& q,
                               TaskJacobian& J_base_transfer) const;
  /// Leaves out the joints at a limit that the error pushes across.
  void hold(const JointVector& q, const TaskError& error, TaskJacobian& J_base_transfer) const;
  void clamp_to_limits(JointVector& q) const;
  /// Pull of each joint towards mid-range: 0 within limits. \return whether any is not 0.
  bool steer(const JointVector& q, JointVector& pull) const;

  std::vector<Step> steps_;
  Eigen::Matrix3d R_last_transfer_;
  Eigen::Vector3d p_last_transfer_;
  TaskAxes axes_;
  bool redundant_ = false;
};

}  // namespace kinship::inverse
