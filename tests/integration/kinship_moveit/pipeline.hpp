#pragma once

#include "tests/integration/kinship_moveit/plugin_cell.hpp"

namespace kinship::kinship_moveit_test {

/// A planning pipeline of MoveIt with Kinship's adapters around a planner of the test: in Humble
/// one adapter around it, from Jazzy on one before and one after.
class Pipeline {
 public:
  using Search = std::function<void(const MotionPlanRequest&, MotionPlanResponse&)>;

  Pipeline(PluginCell& cell, const rclcpp::Node::SharedPtr& node)
#ifdef KINSHIP_STUB_HUMBLE
      : request_(cell.load<planning_request_adapter::PlanningRequestAdapter>(
            "planning_request_adapter::PlanningRequestAdapter", "kinship_moveit/RequestAdapter")) {
    request_->initialize(node, "ompl");
  }
#else
      : request_(cell.load<planning_interface::PlanningRequestAdapter>(
            "planning_interface::PlanningRequestAdapter", "kinship_moveit/RequestAdapter")),
        response_(cell.load<planning_interface::PlanningResponseAdapter>(
            "planning_interface::PlanningResponseAdapter", "kinship_moveit/ResponseAdapter")) {
    request_->initialize(node, "ompl");
    response_->initialize(node, "ompl");
  }
#endif

  std::string description() const { return request_->getDescription(); }

  MotionPlanResponse plan(const planning_scene::PlanningSceneConstPtr& scene,
                          MotionPlanRequest asked, const Search& search) {
    MotionPlanResponse response;
#ifdef KINSHIP_STUB_HUMBLE
    std::vector<std::size_t> added;
    request_->adaptAndPlan(
        [&](const auto&, const MotionPlanRequest& plain, MotionPlanResponse& found) {
          search(plain, found);
          return trajectory_of(found) != nullptr;
        },
        scene, asked, response, added);
#else
    if (request_->adapt(scene, asked).val != moveit::core::MoveItErrorCode::SUCCESS)
      return response;
    search(asked, response);
    if (error_code_of(response) == moveit::core::MoveItErrorCode::SUCCESS)
      response_->adapt(scene, asked, response);
#endif
    return response;
  }
  /// By the straight line to the first goal.
  MotionPlanResponse plan(const std::shared_ptr<planning_scene::PlanningScene>& scene,
                          const MotionPlanRequest& asked) {
    return plan(scene, asked, [&](const MotionPlanRequest& plain, MotionPlanResponse& found) {
      auto path =
          std::make_shared<robot_trajectory::RobotTrajectory>(scene->model, plain.group_name);
      moveit::core::RobotState state = scene->state;
      path->addSuffixWayPoint(state, 0);
      Eigen::Index i = 0;
      for (const auto& joint : plain.goal_constraints.front().joint_constraints)
        state.q[i++] = joint.position;
      path->addSuffixWayPoint(state, 0);
      trajectory_of(found) = path;
      succeed(found);
    });
  }

 private:
  static void succeed(MotionPlanResponse& response) {
#ifdef KINSHIP_STUB_HUMBLE
    response.error_code_.val = moveit_msgs::msg::MoveItErrorCodes::SUCCESS;
#else
    response.error_code.val = moveit_msgs::msg::MoveItErrorCodes::SUCCESS;
#endif
  }

#ifdef KINSHIP_STUB_HUMBLE
  std::shared_ptr<planning_request_adapter::PlanningRequestAdapter> request_;
#else
  std::shared_ptr<planning_interface::PlanningRequestAdapter> request_;
  std::shared_ptr<planning_interface::PlanningResponseAdapter> response_;
#endif
};

}  // namespace kinship::kinship_moveit_test
