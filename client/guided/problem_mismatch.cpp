#include "client/guided/problem_mismatch.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "proto/types/number_text.hpp"
#include "proto/types/pose.hpp"

namespace kinship::guided {
namespace {

/// Six digits behind the point, or as many as tell a value from a limit that it hardly exceeds.
std::string value_text(double value) {
  constexpr double kSixDigits = 1e6;
  return std::abs(std::round(kSixDigits * value) / kSixDigits - value) < 1e-12
             ? std::to_string(value)
             : number_text(value);
}

/// Moves the joints of `q` that are beyond a limit by less than the slack, and says so of each.
/// \param of  the name of `q`, e.g. "goal 2".
void move_onto_limits(const kinematics::Chain& chain, double slack, const std::string& of,
                      Eigen::Ref<Eigen::VectorXd> q, std::vector<std::string>& said) {
  for (Eigen::Index i = 0; i < chain.dof(); ++i) {
    const kinematics::Joint& joint = chain.joints()[static_cast<std::size_t>(i)];
    const double nearest = std::clamp(q[i], joint.lower, joint.upper);
    const double excess = std::abs(q[i] - nearest);
    if (joint.type == kinematics::JointType::Continuous || excess == 0 || !(excess < slack))
      continue;
    said.push_back(of + ": joint '" + joint.name + "' at " + number_text(q[i]) +
                   " is moved onto its limit " + number_text(nearest));
    q[i] = nearest;
  }
}

/// The first joint of a configuration that is beyond its limits, with its value and the limits.
std::optional<std::string> beyond_limits(const kinematics::Chain& chain,
                                         const Eigen::Ref<const Eigen::VectorXd>& q) {
  for (Eigen::Index i = 0; i < chain.dof(); ++i) {
    const kinematics::Joint& joint = chain.joints()[static_cast<std::size_t>(i)];
    if (joint.type == kinematics::JointType::Continuous)
      continue;
    if (q[i] < joint.lower || q[i] > joint.upper)
      return "joint '" + joint.name + "' at " + value_text(q[i]) + " is outside " +
             value_text(joint.lower) + " to " + value_text(joint.upper);
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

WithinLimits::WithinLimits(const kinematics::Chain& chain, const Problem& problem, double slack)
    : problem_(problem) {
  Eigen::VectorXd start = problem.start;
  Eigen::MatrixXd goals = problem.goal_configurations;
  if (start.size() == chain.dof())
    move_onto_limits(chain, slack, "start", start, said_);
  for (Eigen::Index i = 0; goals.rows() == chain.dof() && i < goals.cols(); ++i)
    move_onto_limits(chain, slack, "goal " + std::to_string(i + 1), goals.col(i), said_);
  if (said_.empty())
    return;
  moved_ = problem;
  moved_->start = std::move(start);
  moved_->goal_configurations = std::move(goals);
}

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

std::optional<Mismatch> find_other_placement(const Problem& problem,
                                             const Eigen::Isometry3d& T_task_base) {
  constexpr double kSame_m = 2e-3, kSame_rad = 2e-3;
  const Eigen::Isometry3d asked = problem.T_task_base.value_or(Eigen::Isometry3d::Identity());
  const Eigen::Isometry3d apart = T_task_base.inverse() * asked;
  if (apart.translation().norm() <= kSame_m &&
      Eigen::AngleAxisd(apart.linear()).angle() <= kSame_rad)
    return std::nullopt;
  const auto text = [](const Eigen::Isometry3d& pose) {
    std::string numbers;
    for (const double number : to_pose_array(pose))
      numbers += (numbers.empty() ? "" : " ") + number_text(number);
    return numbers;
  };
  return Mismatch{NotPlanned::Error,
                  "T_task_base is " +
                      (problem.T_task_base ? text(asked) : "not given, so identity") +
                      ", the guidance was made for " + text(T_task_base)};
}

}  // namespace kinship::guided
