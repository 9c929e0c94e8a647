// Another planner than Kinship's: answers with the straight line to a joint goal, two waypoints.
#include <pluginlib/class_list_macros.hpp>

#if __has_include(<moveit/planning_interface/planning_response_adapter.hpp>)
#include <moveit/planning_interface/planning_interface.hpp>
#else
#include <moveit/planning_interface/planning_interface.h>
#endif

namespace kinship_moveit_test {

using planning_interface::MotionPlanDetailedResponse;
using planning_interface::MotionPlanResponse;

class StraightContext : public planning_interface::PlanningContext {
 public:
  using PlanningContext::PlanningContext;

  planning_interface::StubSolved solve(MotionPlanResponse& response) override {
    auto path = std::make_shared<robot_trajectory::RobotTrajectory>(
        planning_scene_->getRobotModel(), group_);
    moveit::core::RobotState state = planning_scene_->state;
    path->addSuffixWayPoint(state, 0);
    std::vector<double> goal;
    for (const auto& joint : request_.goal_constraints.front().joint_constraints)
      goal.push_back(joint.position);
    state.setJointGroupPositions(path->getGroup(), goal.data());
    path->addSuffixWayPoint(state, 0);
#ifdef KINSHIP_STUB_HUMBLE
    response.trajectory_ = path;
    response.error_code_.val = moveit_msgs::msg::MoveItErrorCodes::SUCCESS;
    return true;
#else
    response.trajectory = path;
    response.error_code.val = moveit_msgs::msg::MoveItErrorCodes::SUCCESS;
#endif
  }
  planning_interface::StubSolved solve(MotionPlanDetailedResponse&) override {
    return static_cast<planning_interface::StubSolved>(false);
  }
  bool terminate() override { return true; }
  void clear() override {}
};

class StraightPlanner : public planning_interface::PlannerManager {
 public:
  std::string getDescription() const override { return "straight"; }
  planning_interface::PlanningContextPtr getPlanningContext(
      const planning_scene::PlanningSceneConstPtr& scene,
      const planning_interface::MotionPlanRequest& request,
      moveit_msgs::msg::MoveItErrorCodes&) const override {
    auto context = std::make_shared<StraightContext>("straight", request.group_name);
    context->setPlanningScene(scene);
    context->setMotionPlanRequest(request);
    return context;
  }
  bool canServiceRequest(const planning_interface::MotionPlanRequest&) const override {
    return true;
  }
  void setPlannerConfigurations(const planning_interface::PlannerConfigurationMap&) override {}
};

}  // namespace kinship_moveit_test

PLUGINLIB_EXPORT_CLASS(kinship_moveit_test::StraightPlanner, planning_interface::PlannerManager)
