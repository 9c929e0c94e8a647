#include "server/transfer/transfer.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "robots/inverse/inverse.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "server/transfer/resample.hpp"

namespace kinship::transfer {
namespace {

using inverse::NoSolution;

constexpr double kSamePlacement = 1e-9;  // m and rad

bool same_robot_and_place(const kinematics::Chain& source, const kinematics::Chain& target,
                          const Eigen::Isometry3d& T_target_source) {
  const double difference =
      (T_target_source.matrix() - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff();
  return difference <= kSamePlacement && source.digest() == target.digest();
}

/// Turns continuous joints into [-pi, pi], where the limits of what is sampled lie.
void unwind(const kinematics::Chain& robot, Eigen::MatrixXd& waypoints) {
  for (Eigen::Index joint = 0; joint < robot.dof(); ++joint)
    if (robot.joints()[static_cast<std::size_t>(joint)].type == kinematics::JointType::Continuous)
      waypoints.row(joint) = waypoints.row(joint).unaryExpr(
          [](double value) { return std::remainder(value, 2 * std::numbers::pi); });
}

TransferredPath taken_over(const kinematics::Chain& robot, Eigen::MatrixXd waypoints) {
  const Eigen::Index count = waypoints.cols();
  unwind(robot, waypoints);
  TransferredPath result;
  result.configurations = std::move(waypoints);
  result.pose_index = Eigen::VectorXi::LinSpaced(count, 0, static_cast<int>(count) - 1);
  result.solution_index = Eigen::VectorXi::Zero(count);
  result.weights = Eigen::VectorXd::Ones(count);
  result.summary.poses = static_cast<std::uint64_t>(count);
  result.summary.poses_solved = result.summary.poses;
  result.summary.configurations = result.summary.poses;
  return result;
}

void count(const inverse::InverseSolutions& solutions, TransferSummary& summary) {
  ++summary.poses;
  summary.configurations += static_cast<std::uint64_t>(solutions.configurations.cols());
  switch (solutions.reason) {
    case NoSolution::None:
      ++summary.poses_solved;
      return;
    case NoSolution::OutOfReach:
      ++summary.out_of_reach;
      return;
    case NoSolution::Limits:
      ++summary.outside_limits;
      return;
    case NoSolution::NotConverged:
      ++summary.not_converged;
      return;
  }
}

/// One row per solution, in the order of poses.
TransferredPath stacked(const std::vector<Eigen::MatrixXd>& solutions_of_pose,
                        const TransferSummary& summary, Eigen::Index dof) {
  const auto total = static_cast<Eigen::Index>(summary.configurations);
  TransferredPath result;
  result.configurations.resize(dof, total);
  result.pose_index.resize(total);
  result.solution_index.resize(total);
  result.weights = Eigen::VectorXd::Ones(total);
  result.summary = summary;
  Eigen::Index next = 0;
  for (std::size_t pose = 0; pose < solutions_of_pose.size(); ++pose) {
    const Eigen::MatrixXd& solutions = solutions_of_pose[pose];
    for (Eigen::Index i = 0; i < solutions.cols(); ++i, ++next) {
      result.configurations.col(next) = solutions.col(i);
      result.pose_index[next] = static_cast<int>(pose);
      result.solution_index[next] = static_cast<int>(i);
    }
  }
  return result;
}

}  // namespace

TransferredPath transfer_path(const Path& path, const kinematics::Chain& source,
                              const kinematics::Chain& target,
                              const Eigen::Isometry3d& T_target_source,
                              const TransferParameters& parameters, std::uint64_t seed) {
  if (path.dof() != source.dof())
    throw std::invalid_argument("transfer_path: a path of " + std::to_string(path.dof()) +
                                " joints for a source robot of " + std::to_string(source.dof()));
  Eigen::MatrixXd waypoints = resample(path, parameters);
  if (same_robot_and_place(source, target, T_target_source))
    return taken_over(target, std::move(waypoints));

  const Eigen::Isometry3d T_transfer_tip = target.T_tip_transfer().inverse();
  const inverse::InverseOptions options{.max_solutions = parameters.max_solutions,
                                        .min_distance = parameters.min_distance,
                                        .seed = seed};
  std::vector<Eigen::MatrixXd> solutions_of_pose;
  TransferSummary summary;
  for (Eigen::Index i = 0; i < waypoints.cols(); ++i) {
    const Eigen::Isometry3d T_target_tip =
        T_target_source * kinematics::T_base_transfer(source, waypoints.col(i)) * T_transfer_tip;
    inverse::InverseSolutions solutions = inverse::inverse(target, T_target_tip, options);
    count(solutions, summary);
    solutions_of_pose.push_back(std::move(solutions.configurations));
  }
  return stacked(solutions_of_pose, summary, target.dof());
}

}  // namespace kinship::transfer
