#include "server/transfer/arm_shape.hpp"

#include <span>
#include <vector>

#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::transfer {
namespace {

/// Where a point of a shape is, and the last joint before it.
struct ShapePoint {
  Eigen::Vector3d p_base;
  Eigen::Index joint = 0;
  double share = 0;  ///< of the line from there to the next joint
};

using ShapePoints = std::array<ShapePoint, kShapeShares.size()>;
using Corners = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, static_cast<int>(kMaxDof) + 1>;

/// Corners of the line along the arm.
Corners corners(const kinematics::Chain& arm, std::span<const Eigen::Isometry3d> T_base_joints) {
  Corners points(3, arm.dof() + 1);
  for (Eigen::Index j = 0; j < arm.dof(); ++j)
    points.col(j) = T_base_joints[static_cast<std::size_t>(j)].translation();
  points.col(arm.dof()) = T_base_joints[arm.joints().size() - 1] *
                          (arm.T_last_tip() * arm.T_tip_transfer().translation());
  return points;
}

ShapePoints shape_points(const Corners& points) {
  const Eigen::Index last = points.cols() - 1;
  const Eigen::VectorXd lengths =
      (points.rightCols(last) - points.leftCols(last)).colwise().norm().transpose();
  const double total = lengths.sum();
  ShapePoints found;
  Eigen::Index segment = 0;
  double before = 0;  // length up to the segment
  for (std::size_t i = 0; i < kShapeShares.size(); ++i) {
    const double at = kShapeShares[i] * total;
    while (segment + 1 < last && before + lengths[segment] < at)
      before += lengths[segment++];
    const double within = lengths[segment] > 0 ? (at - before) / lengths[segment] : 0;
    found[i] = {points.col(segment) + within * (points.col(segment + 1) - points.col(segment)),
                segment, within};
  }
  return found;
}

ArmShape shape_of(const ShapePoints& points) {
  ArmShape shape;
  for (std::size_t i = 0; i < points.size(); ++i)
    shape.col(static_cast<Eigen::Index>(i)) = points[i].p_base;
  return shape;
}

}  // namespace

ArmShape arm_shape(const kinematics::Chain& arm, const Eigen::Ref<const Eigen::VectorXd>& q) {
  return arm_shape(arm, kinematics::joint_poses(arm, q));
}

ArmShape arm_shape(const kinematics::Chain& arm, std::span<const Eigen::Isometry3d> T_base_joints) {
  return shape_of(shape_points(corners(arm, T_base_joints)));
}

std::optional<inverse::LaneMarks> shape_marks(const kinematics::Chain& arm) {
  static_assert(kShapeShares.size() == inverse::kLaneMarks);
  for (const kinematics::Joint& joint : arm.joints())
    if (joint.type == kinematics::JointType::Prismatic)
      return std::nullopt;
  const ShapePoints points =
      shape_points(corners(arm, kinematics::joint_poses(arm, Eigen::VectorXd::Zero(arm.dof()))));
  inverse::LaneMarks marks{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    marks.joint[i] = static_cast<int>(points[i].joint);
    marks.share[i] = points[i].share;
  }
  return marks;
}

ArmShapeMotion arm_shape_motion(const kinematics::Chain& arm,
                                const Eigen::Ref<const Eigen::VectorXd>& q) {
  const std::vector<Eigen::Isometry3d> T_base_joints = kinematics::joint_poses(arm, q);
  const Corners line = corners(arm, T_base_joints);
  const ShapePoints points = shape_points(line);
  ArmShapeMotion motion;
  motion.shape = shape_of(points);
  motion.J_points.setZero(ArmShapeMotion::kRows, arm.dof());
  motion.J_pose.setZero(6, arm.dof());
  for (Eigen::Index j = 0; j < arm.dof(); ++j) {
    const Eigen::Isometry3d& T_base_joint = T_base_joints[static_cast<std::size_t>(j)];
    const kinematics::Joint& joint = arm.joints()[static_cast<std::size_t>(j)];
    const Eigen::Vector3d axis = T_base_joint.linear() * joint.axis;
    const bool turns = joint.type != kinematics::JointType::Prismatic;
    const auto velocity = [&](const Eigen::Vector3d& p_base) -> Eigen::Vector3d {
      return turns ? axis.cross(p_base - T_base_joint.translation()) : axis;
    };
    for (std::size_t i = 0; i < points.size(); ++i)
      if (j <= points[i].joint)
        motion.J_points.block<3, 1>(3 * static_cast<Eigen::Index>(i), j) =
            velocity(points[i].p_base);
    motion.J_pose.col(j).head<3>() = velocity(line.rightCols<1>());
    if (turns)
      motion.J_pose.col(j).tail<3>() = axis;
  }
  return motion;
}

ArmShape moved(const Eigen::Isometry3d& T_a_b, const ArmShape& shape_in_b) {
  return (T_a_b.linear() * shape_in_b).colwise() + T_a_b.translation();
}

}  // namespace kinship::transfer
