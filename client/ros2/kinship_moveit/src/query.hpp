#pragma once

#include <atomic>
#include <ctime>
#include <memory>
#include <optional>
#include <string>

#include "arm.hpp"
#include "goals.hpp"
#include "scene_objects.hpp"
#include "session.hpp"

namespace kinship_moveit {

/// One planning call: its task, placement, scene, and what guides it.
struct Query {
  std::weak_ptr<const planning_scene::PlanningScene> scene;
  std::shared_ptr<Arm> arm;
  std::string task;
  PoseNumbers T_task_base{};
  Eigen::Isometry3d T_task_world = Eigen::Isometry3d::Identity();
  Guidance guidance;
  kinship_sampling sampling = KINSHIP_UNIFORM;
  double share = 0;  ///< of samples of the sampler, 0 to 1
  moveit::core::RobotStatePtr start;
  std::shared_ptr<const SceneObjects> objects;
  Goals goals;
  double time_limit_s = 0;
  // By the thread that plans:
  mutable bool is_reported = false;
  mutable bool was_recalled = false;  ///< stored paths were tried
};

/// Begins the query of this thread: finds its task, takes "@TASK" from the request's planner_id,
/// and makes it the one that samplers of the group serve.
/// \return null if the group is not one of Kinship (yet), or the request has no task.
std::shared_ptr<const Query> begin_query(Session& session,
                                         const planning_scene::PlanningSceneConstPtr& scene,
                                         MotionPlanRequest& request);
/// The last query that began on this thread, until it is ended, if it is of this scene.
std::shared_ptr<const Query> query_of_this_thread(
    const planning_scene::PlanningSceneConstPtr& scene);
void end_query();

/// Offers a stored path, moved onto the query: each configuration and the dense path are valid in
/// the scene, or it is not offered.
/// \return whether the response has it; then it is reported, too.
bool offer_recalled(Session& session, const Query& query,
                    const planning_scene::PlanningSceneConstPtr& scene,
                    const MotionPlanRequest& request, MotionPlanResponse& response);

/// The dense trajectory through configurations, if it is valid in the scene.
/// \param waypoints  dof numbers each. \return null if it is not valid.
robot_trajectory::RobotTrajectoryPtr valid_trajectory(
    const Query& query, const planning_scene::PlanningSceneConstPtr& scene,
    const MotionPlanRequest& request, const std::vector<double>& waypoints);

/// Puts the attempt of another planner into the outbox, behind planning; once a query.
void report(Session& session, const Query& query, const MotionPlanRequest& request,
            MotionPlanResponse& response);

/// Processor time of this thread, s.
inline double thread_time_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace kinship_moveit
