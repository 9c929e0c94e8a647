#include "server/rehearsal/posed_query.hpp"

#include <utility>

#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "server/transfer/scene_filter.hpp"

namespace kinship::rehearsal {
namespace {

/// Of the configurations with the hand at the recorded start.
std::optional<Eigen::VectorXd> find_start(const runtime::Robot& robot,
                                          const Eigen::Isometry3d& T_base_start,
                                          const planning::IsFree& is_free) {
  const Eigen::VectorXd middle = (robot.chain.lower() + robot.chain.upper()) / 2;
  const planning::GoalConfigurations found = planning::goal_configurations(
      robot.chain, T_base_start, planning::planning_bounds(robot.chain, middle), is_free);
  if (found.configurations.cols() == 0)
    return std::nullopt;
  Eigen::Index nearest = 0;
  (found.configurations.colwise() - middle).colwise().norm().minCoeff(&nearest);
  return found.configurations.col(nearest);
}

bool is_start(const kinematics::Chain& chain, const Eigen::VectorXd& q) {
  return q.size() == chain.dof() && q.allFinite() && chain.within_limits(q);
}

}  // namespace

std::optional<PosedQuery> pose_query(const runtime::Robot& robot,
                                     const Eigen::Isometry3d& T_task_base_today,
                                     const RecordedQuery& recorded,
                                     const Eigen::VectorXd& usual_start) {
  PosedQuery posed;
  const Eigen::Isometry3d T_task_base =
      recorded.own ? recorded.own->T_task_base : T_task_base_today;
  const collision::RobotSolids solids(robot.chain, robot.shapes);
  posed.surroundings = recorded.scene
                           ? transfer::recorded_surroundings(solids, *recorded.scene, T_task_base)
                           : collision::Surroundings{T_task_base, {}, {}, {}};
  posed.world = std::make_unique<collision::CollisionWorld>(solids, posed.surroundings);
  const Eigen::Isometry3d T_base_task = T_task_base.inverse();
  const std::optional<TaskSpaceRegion> region =
      recorded.scene ? recorded.scene->constraint : std::nullopt;
  const planning::IsFree is_free = planning::free_in(*posed.world);
  const std::optional<Eigen::VectorXd> start =
      recorded.own ? std::optional<Eigen::VectorXd>(recorded.own->waypoints.col(0))
      : is_start(robot.chain, usual_start) && is_free(usual_start)
          ? std::optional<Eigen::VectorXd>(usual_start)
          : find_start(robot, T_base_task * recorded.T_task_start, is_free);
  if (!start || !is_free(*start))
    return std::nullopt;
  const Eigen::Matrix2Xd bounds = planning::planning_bounds(robot.chain, *start);
  if (region)
    posed.constraint.emplace(robot.chain, *region, T_task_base, bounds);
  planning::GoalConfigurations goals = planning::goal_configurations(
      robot.chain, T_base_task * recorded.T_task_goal, bounds, is_free);
  if (goals.configurations.cols() == 0)
    return std::nullopt;
  posed.query = {T_task_base, bounds, *start, std::move(goals.configurations), recorded.path};
  return posed;
}

}  // namespace kinship::rehearsal
