#include "client/guided/problem_mismatch.hpp"

#include <cstddef>

namespace kinship::planner {
namespace {

/// The first joint of a configuration that is beyond its limits, with its value and the limits.
std::optional<std::string> beyond_limits(const kinematics::Chain& chain,
                                         const Eigen::Ref<const Eigen::VectorXd>& q) {
  constexpr double kRounding = 1e-6;  // of a limit written with few digits
  for (Eigen::Index i = 0; i < chain.dof(); ++i) {
    const kinematics::Joint& joint = chain.joints()[static_cast<std::size_t>(i)];
    if (joint.type == kinematics::JointType::Continuous)
      continue;
    if (q[i] < joint.lower - kRounding || q[i] > joint.upper + kRounding)
      return "joint '" + joint.name + "' at " + std::to_string(q[i]) + " is outside " +
             std::to_string(joint.lower) + " to " + std::to_string(joint.upper);
  }
  return std::nullopt;
}

std::string joint_names(const kinematics::Chain& chain) {
  std::string names;
  for (const kinematics::Joint& joint : chain.joints())
    names += (names.empty() ? "'" : ", '") + joint.name + "'";
  return names;
}

}  // namespace

std::optional<Mismatch> find_mismatch(const kinematics::Chain& chain, const Problem& problem) {
  const auto joints = [](Eigen::Index count) { return std::to_string(count) + " joints"; };
  const auto of_robot = [&] { return std::to_string(chain.dof()) + ": " + joint_names(chain); };
  if (!problem.T_task_start && problem.start.size() != chain.dof())
    return Mismatch{NotPlanned::DofMismatch,
                    "start has " + joints(problem.start.size()) + ", the robot " + of_robot()};
  if (!problem.T_task_goal && problem.goal_configurations.rows() != chain.dof())
    return Mismatch{NotPlanned::DofMismatch, "goal configurations have " +
                                                 joints(problem.goal_configurations.rows()) +
                                                 ", the robot " + of_robot()};
  if (!problem.T_task_start)
    if (const auto outside = beyond_limits(chain, problem.start))
      return Mismatch{NotPlanned::StartBeyondLimits, "start: " + *outside};
  for (Eigen::Index i = 0; i < problem.goal_configurations.cols(); ++i)
    if (const auto outside = beyond_limits(chain, problem.goal_configurations.col(i)))
      return Mismatch{NotPlanned::GoalBeyondLimits,
                      "goal " + std::to_string(i + 1) + ": " + *outside};
  return std::nullopt;
}

}  // namespace kinship::planner
