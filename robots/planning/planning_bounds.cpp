#include "robots/planning/planning_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "proto/types/turn.hpp"

namespace kinship::planning {
namespace {

constexpr double kTolerance = 1e-9;  // a limit at +-pi, rounded, is not wider than a turn

bool is_turning(const kinematics::Joint& joint) {
  return joint.type == kinematics::JointType::Continuous ||
         (joint.type == kinematics::JointType::Revolute &&
          joint.upper - joint.lower > kTurn + kTolerance);
}

}  // namespace

Eigen::Matrix2Xd planning_bounds(const kinematics::Chain& chain,
                                 const Eigen::Ref<const Eigen::VectorXd>& start) {
  if (start.size() != chain.dof() || !start.allFinite())
    throw std::invalid_argument("planning_bounds: start does not fit the chain");
  Eigen::Matrix2Xd bounds(2, chain.dof());
  bounds.row(0) = chain.lower().transpose();
  bounds.row(1) = chain.upper().transpose();
  for (Eigen::Index i = 0; i < chain.dof(); ++i) {
    const kinematics::Joint& joint = chain.joints()[static_cast<std::size_t>(i)];
    if (!is_turning(joint))
      continue;
    double lower = start[i] - kTurn / 2;
    if (joint.type != kinematics::JointType::Continuous)
      lower = std::clamp(lower, joint.lower, joint.upper - kTurn);
    bounds.col(i) << lower, lower + kTurn;
  }
  return bounds;
}

std::vector<bool> turning_joints(const kinematics::Chain& chain) {
  std::vector<bool> turning;
  for (const kinematics::Joint& joint : chain.joints())
    turning.push_back(is_turning(joint));
  return turning;
}

std::optional<Eigen::VectorXd> turned_into(const Eigen::Matrix2Xd& bounds,
                                           const std::vector<bool>& turning,
                                           const Eigen::Ref<const Eigen::VectorXd>& q) {
  Eigen::VectorXd turned = q;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double lower = bounds(0, i) - kTolerance, upper = bounds(1, i) + kTolerance;
    const bool outside = turned[i] < lower || turned[i] > upper;
    if (outside && turning[static_cast<std::size_t>(i)])
      turned[i] += kTurn * std::ceil((lower - turned[i]) / kTurn);
    if (!(turned[i] >= lower && turned[i] <= upper))
      return std::nullopt;
    turned[i] = std::clamp(turned[i], bounds(0, i), bounds(1, i));
  }
  return turned;
}

Eigen::MatrixXd all_turned_into(const Eigen::Matrix2Xd& bounds, const kinematics::Chain& chain,
                                const Eigen::Ref<const Eigen::MatrixXd>& qs) {
  const std::vector<bool> turning = turning_joints(chain);
  Eigen::MatrixXd kept(qs.rows(), qs.cols());
  Eigen::Index count = 0;
  for (const auto& q : qs.colwise())
    if (const auto turned = turned_into(bounds, turning, q))
      kept.col(count++) = *turned;
  return kept.leftCols(count);
}

}  // namespace kinship::planning
