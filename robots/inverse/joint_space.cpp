#include "robots/inverse/joint_space.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kinship::inverse {
namespace {

using kinematics::JointType;

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kRounding = 1e-9;  // joint units

}  // namespace

bool normalize(const kinematics::Chain& chain, Eigen::Ref<Eigen::VectorXd> q) {
  bool inside = true;
  for (Eigen::Index j = 0; j < chain.dof(); ++j) {
    const kinematics::Joint& joint = chain.joints()[static_cast<std::size_t>(j)];
    if (joint.type == JointType::Continuous) {
      const double value = std::remainder(q[j], kTurn);
      q[j] = value <= -std::numbers::pi ? std::numbers::pi : value;
      continue;
    }
    const double middle = 0.5 * (joint.lower + joint.upper);
    if (joint.type == JointType::Revolute)
      q[j] = middle + std::remainder(q[j] - middle, kTurn);
    inside = inside && q[j] >= joint.lower - kRounding && q[j] <= joint.upper + kRounding;
    q[j] = inside ? std::clamp(q[j], joint.lower, joint.upper) : q[j];
  }
  return inside;
}

double distance(const kinematics::Chain& chain, const Eigen::Ref<const Eigen::VectorXd>& a,
                const Eigen::Ref<const Eigen::VectorXd>& b) {
  double squared = 0;
  for (Eigen::Index j = 0; j < chain.dof(); ++j) {
    const bool continuous =
        chain.joints()[static_cast<std::size_t>(j)].type == JointType::Continuous;
    const double difference = continuous ? std::remainder(a[j] - b[j], kTurn) : a[j] - b[j];
    squared += difference * difference;
  }
  return std::sqrt(squared);
}

}  // namespace kinship::inverse
