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

Eigen::Matrix3d rotation_of(const moveit_msgs::msg::OrientationConstraint& constraint) {
  const auto& turn = constraint.orientation;
  return Eigen::Quaterniond(turn.w, turn.x, turn.y, turn.z).normalized().toRotationMatrix();
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
  const auto& offset = position.target_point_offset;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = frame(scene, state, orientation.header.frame_id).linear() * rotation_of(orientation);
  T.translation() =
      frame(scene, state, position.header.frame_id) * Eigen::Vector3d(at.x, at.y, at.z) -
      T.linear() * Eigen::Vector3d(offset.x, offset.y, offset.z);
  return T;
}

/// Whether a link of this name moves as the tip does.
bool moves_with(const moveit::core::RobotModel& model, const std::string& name,
                const std::string& tip_link) {
  using moveit::core::RobotModel;
  const auto* link = model.getLinkModel(name);
  return link != nullptr &&
         RobotModel::getRigidlyConnectedParentLinkModel(link) ==
             RobotModel::getRigidlyConnectedParentLinkModel(model.getLinkModel(tip_link));
}

/// Between two waypoints the planner keeps to its region to 5e-3 rad.
constexpr double kLeft_rad = 6e-3;

}  // namespace

KeptRegion read_path_constraints(const planning_scene::PlanningScene& scene,
                                 const moveit::core::RobotState& state, const Constraints& kept,
                                 const std::string& tip_link, const Eigen::Isometry3d& T_task_world,
                                 const Eigen::Isometry3d& T_tip_transfer) {
  if (!kept.joint_constraints.empty())
    return {{}, "a path constraint on joints"};
  if (!kept.position_constraints.empty())
    return {{}, "a path constraint on a position"};
  if (!kept.visibility_constraints.empty())
    return {{}, "a path constraint on visibility"};
  if (kept.orientation_constraints.empty())
    return {};
  if (kept.orientation_constraints.size() > 1)
    return {{}, "path constraints on several orientations"};
  const auto& wanted = kept.orientation_constraints.front();
  if (!moves_with(*scene.getRobotModel(), wanted.link_name, tip_link))
    return {{}, "a path constraint on a link that does not move with '" + tip_link + "'"};
  auto region = sized<kinship_region>();
  const double tolerances[] = {wanted.absolute_x_axis_tolerance, wanted.absolute_y_axis_tolerance,
                               wanted.absolute_z_axis_tolerance};
  using Constraint = moveit_msgs::msg::OrientationConstraint;
  if (kinship_region_keep_orientation(
          tolerances, wanted.parameterization == Constraint::ROTATION_VECTOR ? 1 : 0, &region) !=
      KINSHIP_OK)
    return {{}, std::string("a path constraint on an orientation: ") + kinship_error_text()};
  for (int i = 3; i < 6; ++i) {
    region.upper[i] -= kLeft_rad;
    region.lower[i] += kLeft_rad;
    if (region.upper[i] <= 0)
      return {{},
              "a path constraint on an orientation to " +
                  std::to_string(region.upper[i] + kLeft_rad) + " rad, must be above " +
                  std::to_string(kLeft_rad)};
  }
  Eigen::Isometry3d T_task_region = Eigen::Isometry3d::Identity();
  T_task_region.linear() = T_task_world.linear() *
                           frame(scene, state, wanted.header.frame_id).linear() *
                           rotation_of(wanted);
  const auto T_task_region_numbers = to_numbers(T_task_region);
  std::copy(T_task_region_numbers.begin(), T_task_region_numbers.end(), region.T_task_region);
  const auto T_region_end = to_numbers(state.getGlobalLinkTransform(wanted.link_name).inverse() *
                                       state.getGlobalLinkTransform(tip_link) * T_tip_transfer);
  std::copy(T_region_end.begin(), T_region_end.end(), region.T_region_end);
  return {region, {}};
}

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
    const std::string& link = goal.position_constraints.front().link_name;
    if (!moves_with(model, link, tip_link))
      goals.untold = "a goal of a link that does not move with '" + tip_link + "'";
    else if (!goals.T_world_tip)
      goals.T_world_tip = *T * state.getGlobalLinkTransform(link).inverse() *
                          state.getGlobalLinkTransform(tip_link);
  }
  return goals;
}

}  // namespace kinship_moveit
