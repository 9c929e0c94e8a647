#pragma once

#include "stub/samplers.hpp"

/// What planners of every release share, and what differs between Humble and later ones.
namespace planning_interface {

using MotionPlanRequest = moveit_msgs::msg::MotionPlanRequest;

#ifdef KINSHIP_STUB_HUMBLE
struct MotionPlanResponse {
  robot_trajectory::RobotTrajectoryPtr trajectory_;
  double planning_time_ = 0;
  moveit_msgs::msg::MoveItErrorCodes error_code_;
};
struct MotionPlanDetailedResponse {
  std::vector<robot_trajectory::RobotTrajectoryPtr> trajectory_;
  std::vector<std::string> description_;
  std::vector<double> processing_time_;
  moveit_msgs::msg::MoveItErrorCodes error_code_;
};
using StubSolved = bool;
#else
}  // namespace planning_interface
namespace moveit::core {
class MoveItErrorCode : public moveit_msgs::msg::MoveItErrorCodes {
 public:
  MoveItErrorCode(int code = UNDEFINED) { val = code; }  // NOLINT: as MoveIt's, from a number
};
}  // namespace moveit::core
namespace planning_interface {
struct MotionPlanResponse {
  robot_trajectory::RobotTrajectoryPtr trajectory;
  double planning_time = 0;
  moveit::core::MoveItErrorCode error_code = moveit::core::MoveItErrorCode::FAILURE;
  std::string planner_id;
};
struct MotionPlanDetailedResponse {
  std::vector<robot_trajectory::RobotTrajectoryPtr> trajectory;
  std::vector<std::string> description;
  std::vector<double> processing_time;
  moveit_msgs::msg::MoveItErrorCodes error_code;
};
using StubSolved = void;
#endif

struct PlannerConfigurationSettings {};
using PlannerConfigurationMap = std::map<std::string, PlannerConfigurationSettings>;

class PlanningContext {
 public:
  PlanningContext(std::string name, std::string group)
      : name_(std::move(name)), group_(std::move(group)) {}
  virtual ~PlanningContext() = default;
  void setPlanningScene(const planning_scene::PlanningSceneConstPtr& scene) {
    planning_scene_ = scene;
  }
  void setMotionPlanRequest(const MotionPlanRequest& request) { request_ = request; }
  virtual StubSolved solve(MotionPlanResponse& response) = 0;
  virtual StubSolved solve(MotionPlanDetailedResponse& response) = 0;
  virtual bool terminate() = 0;
  virtual void clear() = 0;

 protected:
  std::string name_, group_;
  planning_scene::PlanningSceneConstPtr planning_scene_;
  MotionPlanRequest request_;
};
using PlanningContextPtr = std::shared_ptr<PlanningContext>;

class PlannerManager {
 public:
  virtual ~PlannerManager() = default;
  virtual bool initialize(const moveit::core::RobotModelConstPtr&, const rclcpp::Node::SharedPtr&,
                          const std::string&) {
    return true;
  }
  virtual std::string getDescription() const { return ""; }
  virtual void getPlanningAlgorithms(std::vector<std::string>&) const {}
  virtual PlanningContextPtr getPlanningContext(const planning_scene::PlanningSceneConstPtr& scene,
                                                const MotionPlanRequest& request,
                                                moveit_msgs::msg::MoveItErrorCodes& code) const = 0;
  virtual bool canServiceRequest(const MotionPlanRequest& request) const = 0;
  virtual void setPlannerConfigurations(const PlannerConfigurationMap& configurations) = 0;

 protected:
  PlannerConfigurationMap config_settings_;
};
using PlannerManagerPtr = std::shared_ptr<PlannerManager>;

#ifndef KINSHIP_STUB_HUMBLE
class PlanningRequestAdapter {
 public:
  virtual ~PlanningRequestAdapter() = default;
  virtual void initialize(const rclcpp::Node::SharedPtr&, const std::string&) {}
  virtual std::string getDescription() const = 0;
  virtual moveit::core::MoveItErrorCode adapt(const planning_scene::PlanningSceneConstPtr& scene,
                                              MotionPlanRequest& request) const = 0;
};
class PlanningResponseAdapter {
 public:
  virtual ~PlanningResponseAdapter() = default;
  virtual void initialize(const rclcpp::Node::SharedPtr&, const std::string&) {}
  virtual std::string getDescription() const = 0;
  virtual void adapt(const planning_scene::PlanningSceneConstPtr& scene,
                     const MotionPlanRequest& request, MotionPlanResponse& response) const = 0;
};
#endif

}  // namespace planning_interface

#ifdef KINSHIP_STUB_HUMBLE
namespace planning_request_adapter {

class PlanningRequestAdapter {
 public:
  using PlannerFn = std::function<bool(const planning_scene::PlanningSceneConstPtr&,
                                       const planning_interface::MotionPlanRequest&,
                                       planning_interface::MotionPlanResponse&)>;
  virtual ~PlanningRequestAdapter() = default;
  virtual void initialize(const rclcpp::Node::SharedPtr& node, const std::string& ns) = 0;
  virtual std::string getDescription() const { return ""; }
  virtual bool adaptAndPlan(const PlannerFn& planner,
                            const planning_scene::PlanningSceneConstPtr& scene,
                            const planning_interface::MotionPlanRequest& request,
                            planning_interface::MotionPlanResponse& response,
                            std::vector<std::size_t>& added) const = 0;
};

}  // namespace planning_request_adapter
#endif
