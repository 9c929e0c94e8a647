#include "server/service/turn_cuts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace kinship::service {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// The same angle in [from, from + 2 pi).
double wrapped(double angle, double from) {
  const double turned = angle - kTurn * std::floor((angle - from) / kTurn);
  return turned < from + kTurn ? std::max(turned, from) : from;
}

double middle_of_largest_gap(std::vector<double> angles) {
  for (double& angle : angles)
    angle = wrapped(angle, -std::numbers::pi);
  std::sort(angles.begin(), angles.end());
  double widest = angles.front() + kTurn - angles.back();
  double begin = angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i)
    if (angles[i] - angles[i - 1] > widest) {
      widest = angles[i] - angles[i - 1];
      begin = angles[i - 1];
    }
  return wrapped(begin + widest / 2, -std::numbers::pi);
}

}  // namespace

TurnCuts find_cuts(const kinematics::Chain& chain, const Eigen::MatrixXd& configurations) {
  TurnCuts cuts(static_cast<std::size_t>(chain.dof()));
  bool has_cut = false;
  for (Eigen::Index joint = 0; joint < chain.dof(); ++joint) {
    const auto index = static_cast<std::size_t>(joint);
    if (chain.joints()[index].type != kinematics::JointType::Continuous)
      continue;
    const auto angles = configurations.row(joint);
    cuts[index] = middle_of_largest_gap({angles.begin(), angles.end()});
    has_cut = true;
  }
  return has_cut ? cuts : TurnCuts{};
}

void wrap(const TurnCuts& cuts, Eigen::MatrixXd& configurations) {
  for (std::size_t joint = 0; joint < cuts.size(); ++joint)
    if (cuts[joint])
      for (double& angle : configurations.row(static_cast<Eigen::Index>(joint)))
        angle = wrapped(angle, *cuts[joint]);
}

Eigen::Matrix2Xd limits_with(const TurnCuts& cuts, const kinematics::Chain& chain) {
  Eigen::Matrix2Xd limits(2, chain.dof());
  limits.row(0) = chain.lower().transpose();
  limits.row(1) = chain.upper().transpose();
  for (std::size_t joint = 0; joint < cuts.size(); ++joint)
    if (cuts[joint])
      limits.col(static_cast<Eigen::Index>(joint)) << *cuts[joint], *cuts[joint] + kTurn;
  return limits;
}

}  // namespace kinship::service
