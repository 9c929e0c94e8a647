#include "pages/plots/same_query.hpp"

#include <algorithm>
#include <vector>

#include "pages/page/json_text.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::plots {
namespace {

using Poses = std::vector<Eigen::Isometry3d>;

constexpr double kSameJoints = 1e-6;  // joint units, or of a pose's numbers
constexpr double kSame_m = 1e-3, kSame_rad = 0.01;

Eigen::Isometry3d base_of(const Attempt& attempt) {
  return attempt.T_task_base.value_or(Eigen::Isometry3d::Identity());
}

/// Empty: it is not kept.
Eigen::VectorXd start_of(const Attempt& attempt) {
  if (attempt.path)
    return attempt.path->waypoints().col(0);
  return attempt.search ? attempt.search->start : Eigen::VectorXd();
}

/// Poses of the transfer frame at the goals, in the task frame.
Poses goals_of(const Attempt& attempt, const kinematics::Chain& chain) {
  if (!attempt.path && attempt.search && attempt.search->T_task_goal)
    return {*attempt.search->T_task_goal};
  Eigen::MatrixXd goals;
  if (attempt.path)
    goals = attempt.path->waypoints().rightCols<1>();
  else if (attempt.search)
    goals = attempt.search->goals;
  Poses poses;
  if (goals.rows() == chain.dof())
    for (Eigen::Index i = 0; i < goals.cols(); ++i)
      poses.push_back(base_of(attempt) * kinematics::T_base_transfer(chain, goals.col(i)));
  return poses;
}

bool is_same_pose(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Isometry3d difference = a.inverse() * b;
  return difference.translation().norm() <= kSame_m &&
         Eigen::AngleAxisd(difference.rotation()).angle() <= kSame_rad;
}

std::string text_of(const std::optional<RecordedScene>& scene) {
  if (!scene)
    return {};
  std::string text = page::json_of(scene->objects);
  for (const HeldObject& held : scene->held)
    text += ' ' + held.name;
  return text;
}

}  // namespace

bool is_same_query(const AttemptFigure& figure, const Attempt& other) {
  const Attempt& one = figure.attempt;
  const kinematics::Chain& chain = figure.drawn.robot.chain;
  if (one.robot != other.robot)
    return false;
  const Eigen::VectorXd start = start_of(one), other_start = start_of(other);
  if (start.size() != chain.dof() || other_start.size() != chain.dof() ||
      (start - other_start).cwiseAbs().maxCoeff() > kSameJoints ||
      !base_of(one).isApprox(base_of(other), kSameJoints) ||
      text_of(one.scene) != text_of(other.scene))
    return false;
  const Poses goals = goals_of(one, chain), other_goals = goals_of(other, chain);
  return std::ranges::any_of(goals, [&](const Eigen::Isometry3d& goal) {
    return std::ranges::any_of(other_goals, [&](const Eigen::Isometry3d& other_goal) {
      return is_same_pose(goal, other_goal);
    });
  });
}

}  // namespace kinship::plots
