#pragma once

#include <cmath>

#include "robots/inverse/joint_space.hpp"

namespace kinship::test {

/// JointSpace::normalize for one configuration.
inline bool normalize(const kinematics::Chain& chain, Eigen::Ref<Eigen::VectorXd> q) {
  return inverse::JointSpace(chain).normalize(q.data());
}

/// The root of JointSpace::squared_distance.
inline double distance(const kinematics::Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& a,
                       const Eigen::Ref<const Eigen::VectorXd>& b) {
  return std::sqrt(inverse::JointSpace(chain).squared_distance(a.data(), b.data()));
}

}  // namespace kinship::test
