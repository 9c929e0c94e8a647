#pragma once

/// What differs between the releases of MoveIt 2: Humble (2.5) on one side, Jazzy (2.12), Kilted
/// (2.14) and Rolling on the other. No other file asks for the release.
#if __has_include(<moveit/planning_interface/planning_response_adapter.hpp>)
#define KINSHIP_MOVEIT_CHAINS_ADAPTERS 1  // request and response adapters are classes of their own
#define KINSHIP_HUMBLE_OVERRIDE           // a function that only Humble's base class has
#include <moveit/constraint_samplers/constraint_sampler_allocator.hpp>
#include <moveit/constraint_samplers/constraint_sampler_manager.hpp>
#include <moveit/planning_interface/planning_interface.hpp>
#include <moveit/planning_interface/planning_request_adapter.hpp>
#include <moveit/planning_interface/planning_response_adapter.hpp>
#include <moveit/planning_scene/planning_scene.hpp>
#include <moveit/robot_trajectory/robot_trajectory.hpp>
#else
#define KINSHIP_MOVEIT_CHAINS_ADAPTERS 0
#define KINSHIP_HUMBLE_OVERRIDE override
#include <moveit/constraint_samplers/constraint_sampler_allocator.h>
#include <moveit/constraint_samplers/constraint_sampler_manager.h>
#include <moveit/planning_interface/planning_interface.h>
#include <moveit/planning_request_adapter/planning_request_adapter.h>
#include <moveit/planning_scene/planning_scene.h>
#include <moveit/robot_trajectory/robot_trajectory.h>
#endif

namespace kinship_moveit {

using planning_interface::MotionPlanDetailedResponse;
using planning_interface::MotionPlanRequest;
using planning_interface::MotionPlanResponse;
using ErrorCodes = moveit_msgs::msg::MoveItErrorCodes;

#if KINSHIP_MOVEIT_CHAINS_ADAPTERS

using Solved = void;  ///< of PlanningContext::solve

inline robot_trajectory::RobotTrajectoryPtr& trajectory_of(MotionPlanResponse& response) {
  return response.trajectory;
}
inline double& planning_time_of(MotionPlanResponse& response) { return response.planning_time; }
inline auto& error_code_of(MotionPlanResponse& response) { return response.error_code; }
inline void name_planner(MotionPlanResponse& response, const std::string& name) {
  response.planner_id = name;
}
inline void add_to(MotionPlanDetailedResponse& detailed, const MotionPlanResponse& response) {
  detailed.trajectory.push_back(response.trajectory);
  detailed.description.emplace_back("plan");
  detailed.processing_time.push_back(response.planning_time);
  detailed.error_code.val = response.error_code.val;
}
/// A sample of a default sampler, whose inverse kinematics begins at `state`.
inline bool sample_near(constraint_samplers::ConstraintSampler& sampler,
                        moveit::core::RobotState& state, const moveit::core::RobotState& reference,
                        unsigned int attempts) {
  return sampler.sample(state, reference, attempts);
}

#else

using Solved = bool;

inline robot_trajectory::RobotTrajectoryPtr& trajectory_of(MotionPlanResponse& response) {
  return response.trajectory_;
}
inline double& planning_time_of(MotionPlanResponse& response) { return response.planning_time_; }
inline auto& error_code_of(MotionPlanResponse& response) { return response.error_code_; }
inline void name_planner(MotionPlanResponse&, const std::string&) {}
inline void add_to(MotionPlanDetailedResponse& detailed, const MotionPlanResponse& response) {
  detailed.trajectory_.push_back(response.trajectory_);
  detailed.description_.emplace_back("plan");
  detailed.processing_time_.push_back(response.planning_time_);
  detailed.error_code_.val = response.error_code_.val;
}
inline bool sample_near(constraint_samplers::ConstraintSampler& sampler,
                        moveit::core::RobotState& state, const moveit::core::RobotState&,
                        unsigned int attempts) {
  return sampler.project(state, attempts);
}

#endif

inline bool is_success(MotionPlanResponse& response) {
  return error_code_of(response).val == ErrorCodes::SUCCESS;
}

}  // namespace kinship_moveit
