#include "robots/kinematics/forward_kinematics.hpp"

#include <stdexcept>
#include <string>

#include "robots/kinematics/joint_motion.hpp"

namespace kinship::kinematics {
namespace {

void check_size(const Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (q.size() != chain.dof())
    throw std::invalid_argument("forward kinematics: " + std::to_string(q.size()) + " values for " +
                                std::to_string(chain.dof()) + " joints");
}

/// \param visit  called with the pose of each joint's moving frame, from base to tip.
/// \return       the last of them.
template <typename Visit>
Eigen::Isometry3d visit_joints(const Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& q,
                               const Visit& visit) {
  check_size(chain, q);
  Eigen::Isometry3d T_base_joint = Eigen::Isometry3d::Identity();
  Eigen::Index i = 0;
  for (const Joint& joint : chain.joints()) {
    follow(joint.T_previous_joint, T_base_joint);
    move(joint, q[i++], T_base_joint);
    visit(T_base_joint);
  }
  return T_base_joint;
}

}  // namespace

Eigen::Isometry3d T_base_tip(const Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& q) {
  Eigen::Isometry3d T = visit_joints(chain, q, [](const Eigen::Isometry3d&) {});
  follow(chain.T_last_tip(), T);
  return T;
}

Eigen::Isometry3d T_base_transfer(const Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& q) {
  Eigen::Isometry3d T = T_base_tip(chain, q);
  follow(chain.T_tip_transfer(), T);
  return T;
}

Eigen::Isometry3d T_base_transfer(const Chain& chain,
                                  std::span<const Eigen::Isometry3d> T_base_joints) {
  Eigen::Isometry3d T = T_base_joints[chain.joints().size() - 1];
  follow(chain.T_last_tip(), T);
  follow(chain.T_tip_transfer(), T);
  return T;
}

std::vector<Eigen::Isometry3d> joint_poses(const Chain& chain,
                                           const Eigen::Ref<const Eigen::VectorXd>& q) {
  std::vector<Eigen::Isometry3d> poses;
  joint_poses(chain, q, poses);
  return poses;
}

void joint_poses(const Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& q,
                 std::vector<Eigen::Isometry3d>& poses) {
  poses.clear();
  poses.reserve(static_cast<std::size_t>(chain.moving_joints()));
  visit_joints(chain, q,
               [&](const Eigen::Isometry3d& T_base_joint) { poses.push_back(T_base_joint); });
  for (const MimicJoint& mimic : chain.mimics()) {
    Eigen::Isometry3d T_base_joint = Eigen::Isometry3d::Identity();
    if (mimic.before >= 0)
      T_base_joint = poses[static_cast<std::size_t>(mimic.before)];
    follow(mimic.joint.T_previous_joint, T_base_joint);
    move(mimic.joint, mimic.multiplier * q[mimic.source] + mimic.offset, T_base_joint);
    poses.push_back(T_base_joint);
  }
}

std::vector<Eigen::Isometry3d> link_poses(const Chain& chain,
                                          const Eigen::Ref<const Eigen::VectorXd>& q) {
  const std::vector<Eigen::Isometry3d> joints = joint_poses(chain, q);
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(chain.links().size());
  for (const ChainLink& link : chain.links()) {
    Eigen::Isometry3d T_base_link = Eigen::Isometry3d::Identity();
    if (link.joint >= 0)
      T_base_link = joints[static_cast<std::size_t>(link.joint)];
    follow(link.T_joint_link, T_base_link);
    poses.push_back(T_base_link);
  }
  return poses;
}

Jacobian J_base_tip(const Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (q.size() != chain.dof())
    throw std::invalid_argument("Jacobian: " + std::to_string(q.size()) + " values for " +
                                std::to_string(chain.dof()) + " joints");
  // First origin and axis of each joint in the base link, then, with the tip known, its column.
  Jacobian J(6, chain.dof());
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  Eigen::Index i = 0;
  for (const Joint& joint : chain.joints()) {
    follow(joint.T_previous_joint, T);
    J.col(i).head<3>() = T.translation();
    J.col(i).tail<3>() = T.linear() * joint.axis;
    move(joint, q[i++], T);
  }
  follow(chain.T_last_tip(), T);
  i = 0;
  for (const Joint& joint : chain.joints()) {
    const Eigen::Vector3d axis = J.col(i).tail<3>();
    const Eigen::Vector3d lever = T.translation() - J.col(i).head<3>();
    const bool prismatic = joint.type == JointType::Prismatic;
    J.col(i).head<3>() = prismatic ? axis : axis.cross(lever);
    if (prismatic)
      J.col(i).tail<3>().setZero();
    ++i;
  }
  return J;
}

}  // namespace kinship::kinematics
