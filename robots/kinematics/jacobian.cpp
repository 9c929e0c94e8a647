#include "robots/kinematics/jacobian.hpp"

#include <stdexcept>
#include <string>

#include "robots/kinematics/joint_motion.hpp"

namespace kinship::kinematics {

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
