#include "server/transfer/transfer.hpp"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "robots/inverse/inverse.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "server/transfer/resample.hpp"
#include "server/transfer/take_over.hpp"

namespace kinship::transfer {
namespace {

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

TransferredPath transfer_path(const Path& path, const ArmPair& pair,
                              const Eigen::Isometry3d& T_target_source,
                              const TransferParameters& parameters, std::uint64_t seed,
                              const Filters& filters) {
  if (path.dof() != pair.source().dof())
    throw std::invalid_argument("transfer_path: a path of " + std::to_string(path.dof()) +
                                " joints for a source robot of " +
                                std::to_string(pair.source().dof()));
  const Eigen::MatrixXd waypoints = resample(path, parameters);
  if (pair.takes_over(T_target_source))
    return take_over(waypoints, pair);

  const Eigen::Isometry3d T_transfer_tip = pair.target().T_tip_transfer().inverse();
  const inverse::InverseOptions options{.max_solutions = parameters.max_solutions,
                                        .min_distance = parameters.min_distance,
                                        .seed = seed};
  std::vector<Eigen::MatrixXd> solutions_of_pose;
  TransferSummary summary;
  CountedFilters counted(filters);
  for (Eigen::Index i = 0; i < waypoints.cols(); ++i) {
    const Eigen::Isometry3d T_target_tip =
        T_target_source * kinematics::T_base_transfer(pair.source(), waypoints.col(i)) *
        T_transfer_tip;
    inverse::InverseSolutions solutions = inverse::inverse(pair.target(), T_target_tip, options);
    Eigen::MatrixXd kept = passed(std::move(solutions.configurations), counted);
    summary.random_configurations += static_cast<std::uint64_t>(kept.cols());
    if (kept.cols() == 0 && solutions.reason == inverse::NoSolution::None)
      summary.count_colliding();
    else
      summary.count(kept.cols(), solutions.reason);
    solutions_of_pose.push_back(std::move(kept));
  }
  summary.set(counted);
  return stacked(solutions_of_pose, summary, pair.target().dof());
}

}  // namespace kinship::transfer
