#include "server/fitting/branch_cuts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace kinship::fitting {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// The same angle in [from, from + 2 pi).
double wrapped(double angle, double from) {
  const double turned = angle - kTurn * std::floor((angle - from) / kTurn);
  return turned < from + kTurn ? std::max(turned, from) : from;
}

std::vector<double> angles_of(const Eigen::MatrixXd& configurations, Eigen::Index joint) {
  const Eigen::VectorXd angles = configurations.row(joint).transpose();
  return {angles.begin(), angles.end()};
}

/// Between neighbouring angles of a circle.
struct Gap {
  double begin = 0, width = 0;
};

Gap largest_gap(std::vector<double> angles) {
  for (double& angle : angles)
    angle = wrapped(angle, -std::numbers::pi);
  std::sort(angles.begin(), angles.end());
  Gap widest{angles.back(), angles.front() + kTurn - angles.back()};
  for (std::size_t i = 1; i < angles.size(); ++i)
    if (angles[i] - angles[i - 1] > widest.width)
      widest = {angles[i - 1], angles[i] - angles[i - 1]};
  return widest;
}

double middle_of_largest_gap(std::vector<double> angles) {
  const Gap widest = largest_gap(std::move(angles));
  return wrapped(widest.begin + widest.width / 2, -std::numbers::pi);
}

/// Of the gap that an angle lies in.
double width_of_gap_at(double cut, const std::vector<double>& angles) {
  double least = kTurn, most = 0;  // behind the cut
  for (const double angle : angles) {
    const double behind = wrapped(angle, cut) - cut;
    least = std::min(least, behind);
    most = std::max(most, behind);
  }
  return least + kTurn - most;
}

}  // namespace

BranchCuts find_cuts(const kinematics::Chain& chain, const Eigen::MatrixXd& configurations) {
  BranchCuts cuts(static_cast<std::size_t>(chain.dof()));
  bool has_cut = false;
  for (Eigen::Index joint = 0; joint < chain.dof(); ++joint) {
    const auto index = static_cast<std::size_t>(joint);
    if (chain.joints()[index].type != kinematics::JointType::Continuous)
      continue;
    cuts[index] = middle_of_largest_gap(angles_of(configurations, joint));
    has_cut = true;
  }
  return has_cut ? cuts : BranchCuts{};
}

bool still_cuts(const BranchCuts& cuts, const kinematics::Chain& chain,
                const Eigen::MatrixXd& configurations) {
  for (Eigen::Index joint = 0; joint < chain.dof(); ++joint) {
    const auto index = static_cast<std::size_t>(joint);
    if (chain.joints()[index].type != kinematics::JointType::Continuous)
      continue;
    if (index >= cuts.size() || !cuts[index])
      return false;
    const std::vector<double> angles = angles_of(configurations, joint);
    if (width_of_gap_at(*cuts[index], angles) < largest_gap(angles).width / 2)
      return false;
  }
  return true;
}

void wrap(const BranchCuts& cuts, Eigen::MatrixXd& configurations) {
  for (std::size_t joint = 0; joint < cuts.size(); ++joint)
    if (cuts[joint])
      for (double& angle : configurations.row(static_cast<Eigen::Index>(joint)))
        angle = wrapped(angle, *cuts[joint]);
}

Eigen::Matrix2Xd limits_with(const BranchCuts& cuts, const kinematics::Chain& chain) {
  Eigen::Matrix2Xd limits(2, chain.dof());
  limits.row(0) = chain.lower().transpose();
  limits.row(1) = chain.upper().transpose();
  for (std::size_t joint = 0; joint < cuts.size(); ++joint)
    if (cuts[joint])
      limits.col(static_cast<Eigen::Index>(joint)) << *cuts[joint], *cuts[joint] + kTurn;
  return limits;
}

}  // namespace kinship::fitting
