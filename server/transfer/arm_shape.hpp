#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>

#include "proto/types/limits.hpp"
#include "robots/inverse/lanes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::transfer {

/// Positions of the points of an arm's shape: shares of the length of the line from the first
/// joint's origin over the other joints' origins to the transfer frame.
inline constexpr std::array<double, 4> kShapeShares = {0.2, 0.4, 0.6, 0.8};

/// Points along an arm, m, one column per share of kShapeShares.
using ArmShape = Eigen::Matrix<double, 3, static_cast<int>(kShapeShares.size())>;

/// The shape of an arm at a configuration, in its base link. Arms of different numbers of joints
/// and different lengths have shapes that can be compared.
/// \param q  dof, joint units.
ArmShape arm_shape(const kinematics::Chain& arm, const Eigen::Ref<const Eigen::VectorXd>& q);
/// \param T_base_joints  kinematics::joint_poses of the configuration.
ArmShape arm_shape(const kinematics::Chain& arm, std::span<const Eigen::Isometry3d> T_base_joints);

/// Places of the points of a shape on an arm, for the kernels; none for an arm with prismatic
/// joints, along which they move.
std::optional<inverse::LaneMarks> shape_marks(const kinematics::Chain& arm);

/// A shape, with its derivative and that of the transfer frame with respect to the joints.
struct ArmShapeMotion {
  static constexpr int kRows = ArmShape::RowsAtCompileTime * ArmShape::ColsAtCompileTime;
  template <int Rows>
  using Derivative =
      Eigen::Matrix<double, Rows, Eigen::Dynamic, 0, Rows, static_cast<int>(kMaxDof)>;

  ArmShape shape;
  /// x, y, z of one point after the other, m per joint unit, each point fixed to the link it lies
  /// on. (With prismatic joints the points also move along the arm; that part is left out.)
  Derivative<kRows> J_points;
  Derivative<6> J_pose;  ///< of the transfer frame: linear velocity, then angular, in the base link
};

/// \param q  dof, joint units.
ArmShapeMotion arm_shape_motion(const kinematics::Chain& arm,
                                const Eigen::Ref<const Eigen::VectorXd>& q);

/// The same shape seen from another frame.
ArmShape moved(const Eigen::Isometry3d& T_a_b, const ArmShape& shape_in_b);

/// Distance of two shapes, m: the root of the summed squared distances of their points.
inline double shape_distance(const ArmShape& a, const ArmShape& b) { return (a - b).norm(); }

}  // namespace kinship::transfer
