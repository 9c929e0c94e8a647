#include "goals.hpp"

#include <algorithm>

namespace kinship_moveit {
namespace {

using moveit_msgs::msg::Constraints;

/// \return empty unless the constraints name each variable of the group.
std::vector<double> configuration_of(const Constraints& goal,
                                     const std::vector<std::string>& variables) {
  std::vector<double> configuration;
  for (const std::string& variable : variables) {
    const auto named =
        std::find_if(goal.joint_constraints.begin(), goal.joint_constraints.end(),
                     [&](const auto& constraint) { return constraint.joint_name == variable; });
    if (named == goal.joint_constraints.end())
      return {};
    configuration.push_back(named->position);
  }
  return configuration;
}

Eigen::Isometry3d frame(const planning_scene::PlanningScene& scene,
                        const moveit::core::RobotState& state, const std::string& id) {
  return id.empty() ? Eigen::Isometry3d::Identity() : scene.getFrameTransform(state, id);
}

/// The pose that a position and an orientation of the same link prescribe.
std::optional<Eigen::Isometry3d> T_world_link(const planning_scene::PlanningScene& scene,
                                              const moveit::core::RobotState& state,
                                              const Constraints& goal) {
  if (goal.position_constraints.size() != 1 || goal.orientation_constraints.size() != 1)
    return std::nullopt;
  const auto& position = goal.position_constraints.front();
  const auto& orientation = goal.orientation_constraints.front();
  if (position.link_name != orientation.link_name ||
      position.constraint_region.primitive_poses.size() != 1)
    return std::nullopt;
  const auto& at = position.constraint_region.primitive_poses.front().position;
  const auto& turn = orientation.orientation;
  const auto& offset = position.target_point_offset;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = frame(scene, state, orientation.header.frame_id).linear() *
               Eigen::Quaterniond(turn.w, turn.x, turn.y, turn.z).normalized().toRotationMatrix();
  T.translation() =
      frame(scene, state, position.header.frame_id) * Eigen::Vector3d(at.x, at.y, at.z) -
      T.linear() * Eigen::Vector3d(offset.x, offset.y, offset.z);
  return T;
}

}  // namespace

Goals read_goals(const planning_scene::PlanningScene& scene, const moveit::core::RobotState& state,
                 const MotionPlanRequest& request, const std::string& tip_link) {
  Goals goals;
  const auto& model = *scene.getRobotModel();
  const auto& variables = model.getJointModelGroup(request.group_name)->getVariableNames();
  for (const Constraints& goal : request.goal_constraints) {
    if (const auto configuration = configuration_of(goal, variables); !configuration.empty()) {
      goals.configurations.insert(goals.configurations.end(), configuration.begin(),
                                  configuration.end());
      continue;
    }
    const auto T = T_world_link(scene, state, goal);
    if (!T) {
      goals.untold = "a goal that is neither a configuration nor one pose of a link";
      continue;
    }
    const auto* link = model.getLinkModel(goal.position_constraints.front().link_name);
    const auto* tip = model.getLinkModel(tip_link);
    using moveit::core::RobotModel;
    if (link == nullptr || RobotModel::getRigidlyConnectedParentLinkModel(link) !=
                               RobotModel::getRigidlyConnectedParentLinkModel(tip))
      goals.untold = "a goal of a link that does not move with '" + tip_link + "'";
    else if (!goals.T_world_tip)
      goals.T_world_tip = *T * state.getGlobalLinkTransform(link->getName()).inverse() *
                          state.getGlobalLinkTransform(tip_link);
  }
  return goals;
}

}  // namespace kinship_moveit
