#include "robots/kinematics/joint_motion.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace kinship::kinematics {

AxisTurns axis_turns(const Eigen::Matrix3d& R) {
  constexpr double kParallel = 1e-12;  // sine between both z-axes
  AxisTurns turns{};
  if (std::hypot(R(0, 2), R(1, 2)) > kParallel)
    turns.before = std::atan2(R(0, 2), -R(1, 2));
  // Of the rest, not of R: where the tilt is small, both turns together are exact.
  const Eigen::Matrix3d rest =
      Eigen::AngleAxisd(-turns.before, Eigen::Vector3d::UnitZ()).toRotationMatrix() * R;
  turns.tilt_sine = -rest(1, 2);
  turns.tilt_cosine = rest(2, 2);
  turns.after = std::atan2(-rest(0, 1), rest(0, 0));
  return turns;
}

Eigen::Matrix3d rotation_of_z_to(const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis).toRotationMatrix();
}

}  // namespace kinship::kinematics
