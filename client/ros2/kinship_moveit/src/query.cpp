#include "query.hpp"

#include <algorithm>
#include <cmath>

namespace kinship_moveit {
namespace {

constexpr double kStep = 0.05;  // between checked configurations, joint units

std::shared_ptr<const Query>& current() {
  thread_local std::shared_ptr<const Query> query;
  return query;
}

/// After '@' in the planner_id, the workspace's frame, or the parameter.
std::string take_task(const Settings& settings, const planning_scene::PlanningScene& scene,
                      MotionPlanRequest& request) {
  if (const auto at = request.planner_id.rfind('@'); at != std::string::npos) {
    const std::string task = request.planner_id.substr(at + 1);
    request.planner_id.erase(at);
    if (!task.empty())
      return task;
  }
  const std::string& workspace = request.workspace_parameters.header.frame_id;
  if (settings.task_from_workspace && !workspace.empty() && workspace != scene.getPlanningFrame())
    return workspace;
  return settings.task;
}

/// Every n-th query with guidance is planned without, to compare.
bool is_control(double fraction) {
  static std::atomic<std::uint64_t> queries = 0;
  const double at = fraction * static_cast<double>(++queries);
  return std::floor(at) > std::floor(at - fraction);
}

void choose(const Settings& settings, Query& query) {
  if (query.guidance.distribution == nullptr && query.guidance.recall == nullptr)
    return;
  query.sampling = is_control(settings.control_fraction) ? KINSHIP_CONTROL : KINSHIP_GUIDED;
  if (query.sampling == KINSHIP_GUIDED && query.guidance.sampler != nullptr)
    query.share = settings.share >= 0 ? settings.share : query.guidance.share;
}

/// What the callbacks of libkinship ask.
struct Asked {
  const planning_scene::PlanningScene& scene;
  const MotionPlanRequest& request;
  const moveit::core::JointModelGroup& joints;
  moveit::core::RobotState state;
};

int is_free(void* user, const double* q, std::size_t) {
  auto& asked = *static_cast<Asked*>(user);
  asked.state.setJointGroupPositions(&asked.joints, q);
  asked.state.update();
  return asked.state.satisfiesBounds(&asked.joints) &&
                 asked.scene.isStateValid(asked.state, asked.request.path_constraints,
                                          asked.request.group_name)
             ? 1
             : 0;
}

kinship_recall_query describe(const Query& query, const std::vector<double>& start,
                              const PoseNumbers& T_task_goal) {
  auto described = sized<kinship_recall_query>();
  described.T_task_base = query.T_task_base.data();
  described.dof = query.arm->dof();
  described.start = start.data();
  described.goals = query.goals.configurations.data();
  described.goal_count = std::min<std::size_t>(query.goals.configurations.size() / query.arm->dof(),
                                               KINSHIP_RECALL_GOALS);
  described.T_task_goal = T_task_goal.data();
  described.objects = query.objects->objects().data();
  described.object_count = query.objects->objects().size();
  described.step = kStep;
  return described;
}

/// What a report needs, apart from the query.
struct Told {
  std::vector<double> waypoints;
  std::string planner, machine;
  double time_s = 0, processor_time_s = 0;
  std::uint64_t checks = 0;
};

void post_report(Session& session, const Query& query, Told told) {
  if (!session.settings().reports || std::exchange(query.is_reported, true))
    return;
  told.machine = session.settings().machine;
  session.post([&session, query = std::make_shared<const Query>(query), told = std::move(told)] {
    auto attempt = sized<kinship_attempt>();
    attempt.robot = &query->arm->robot();
    attempt.task = query->task.c_str();
    attempt.machine = told.machine.c_str();
    attempt.T_task_base = query->T_task_base.data();
    attempt.dof = query->arm->dof();
    attempt.waypoint_count = told.waypoints.size() / attempt.dof;
    attempt.solved = attempt.waypoint_count >= 2 ? 1 : 0;
    attempt.waypoints = told.waypoints.data();
    attempt.planner = told.planner.c_str();
    attempt.planning_time_s = told.time_s;
    attempt.processor_time_s = told.processor_time_s;
    attempt.time_limit_s = query->time_limit_s;
    attempt.collision_checks = told.checks;
    attempt.sampling = query->sampling;
    attempt.share = query->share;
    static const kinship_object kNothing = sized<kinship_object>();
    const auto& objects = query->objects->objects();
    attempt.objects = objects.empty() ? &kNothing : objects.data();
    attempt.object_count = objects.size();
    const auto& allowed = query->objects->allowed_objects();
    attempt.allowed_collisions = allowed.data();
    attempt.allowed_collision_pairs = objects.empty() ? 0 : allowed.size() / 2;
    if (kinship_report(&session.client(), &attempt) != KINSHIP_OK)
      session.warn_once(std::string("a report is not kept: ") + kinship_error_text());
  });
}

}  // namespace

std::shared_ptr<const Query> begin_query(Session& session,
                                         const planning_scene::PlanningSceneConstPtr& scene,
                                         MotionPlanRequest& request) {
  current() = nullptr;
  const Settings& settings = session.settings();
  auto query = std::make_shared<Query>();
  query->scene = scene;
  query->task = take_task(settings, *scene, request);
  query->arm = session.arm(*scene->getRobotModel(), request.group_name);
  if (query->arm == nullptr || query->task.empty()) {
    session.set_latest(request.group_name, nullptr);
    return nullptr;
  }
  query->start = scene->getCurrentStateUpdated(request.start_state);
  query->start->update();
  if (!settings.task_frame.empty())
    query->T_task_world = scene->getFrameTransform(*query->start, settings.task_frame).inverse();
  const Eigen::Isometry3d T_task_base =
      query->T_task_world * query->start->getGlobalLinkTransform(query->arm->base_link());
  query->T_task_base = to_numbers(T_task_base);
  query->time_limit_s = request.allowed_planning_time;
  std::string why;
  query->guidance = query->arm->guidance(session.client(), settings, query->task, T_task_base, why);
  if (!why.empty())
    session.warn_once("task '" + query->task + "' is planned without guidance: " + why);
  for (const std::string& task : settings.tasks_ahead)
    query->arm->follow(session.client(), settings, task, T_task_base);
  choose(settings, *query);
  query->objects =
      std::make_shared<const SceneObjects>(*scene, *query->start, query->arm->tip_link(),
                                           to_pose(settings.T_tip_transfer), query->T_task_world);
  query->goals = read_goals(*scene, *query->start, request, query->arm->tip_link());
  current() = query;
  session.set_latest(request.group_name, query);
  return query;
}

std::shared_ptr<const Query> query_of_this_thread(
    const planning_scene::PlanningSceneConstPtr& scene) {
  const auto& query = current();
  return query != nullptr && query->scene.lock() == scene ? query : nullptr;
}
void end_query() { current() = nullptr; }

robot_trajectory::RobotTrajectoryPtr valid_trajectory(
    const Query& query, const planning_scene::PlanningSceneConstPtr& scene,
    const MotionPlanRequest& request, const std::vector<double>& waypoints) {
  const std::size_t dof = query.arm->dof();
  auto trajectory = std::make_shared<robot_trajectory::RobotTrajectory>(scene->getRobotModel(),
                                                                        request.group_name);
  moveit::core::RobotState state = *query.start;
  const auto* joints = scene->getRobotModel()->getJointModelGroup(request.group_name);
  const auto add = [&](const Eigen::VectorXd& q) {
    state.setJointGroupPositions(joints, q.data());
    state.update();
    trajectory->addSuffixWayPoint(state, 0);
  };
  const Eigen::Map<const Eigen::MatrixXd> path(waypoints.data(), static_cast<Eigen::Index>(dof),
                                               static_cast<Eigen::Index>(waypoints.size() / dof));
  add(path.col(0));
  for (Eigen::Index i = 1; i < path.cols(); ++i) {
    const Eigen::VectorXd step = path.col(i) - path.col(i - 1);
    const int steps = std::max(1, static_cast<int>(std::ceil(step.norm() / kStep)));
    for (int j = 1; j <= steps; ++j)
      add(path.col(i - 1) + step * j / steps);
  }
  if (!scene->isPathValid(*trajectory, request.path_constraints, request.goal_constraints,
                          request.group_name))
    return nullptr;
  return trajectory;
}

bool offer_recalled(Session& session, const Query& query,
                    const planning_scene::PlanningSceneConstPtr& scene,
                    const MotionPlanRequest& request, MotionPlanResponse& response) {
  if (!session.settings().offers_recall || query.sampling != KINSHIP_GUIDED ||
      query.guidance.recall == nullptr || !query.goals.has_any() ||
      std::exchange(query.was_recalled, true))
    return false;
  const double begin_s = thread_time_s();
  const auto& joints = *scene->getRobotModel()->getJointModelGroup(request.group_name);
  std::vector<double> start(query.arm->dof());
  query.start->copyJointGroupPositions(&joints, start.data());
  Asked asked{*scene, request, joints, *query.start};
  const PoseNumbers T_task_goal = to_numbers(
      query.T_task_world * query.goals.T_world_tip.value_or(Eigen::Isometry3d::Identity()) *
      to_pose(session.settings().T_tip_transfer));
  auto described = describe(query, start, T_task_goal);
  described.is_free = is_free;
  described.user = &asked;
  std::vector<double> waypoints(query.arm->dof() * KINSHIP_RECALL_WAYPOINTS);
  auto recalled = sized<kinship_recalled>();
  if (kinship_recall_path(query.guidance.recall.get(), &described, waypoints.data(),
                          KINSHIP_RECALL_WAYPOINTS, &recalled) != KINSHIP_OK) {
    session.warn_once(std::string("no path is recalled: ") + kinship_error_text());
    return false;
  }
  if (recalled.is_recalled == 0)
    return false;
  waypoints.resize(query.arm->dof() * recalled.waypoint_count);
  auto trajectory = valid_trajectory(query, scene, request, waypoints);
  if (trajectory == nullptr)
    return false;
  trajectory_of(response) = trajectory;
  error_code_of(response).val = ErrorCodes::SUCCESS;
  const double time_s = thread_time_s() - begin_s;
  planning_time_of(response) = time_s;
  name_planner(response, "Kinship recall");
  post_report(session, query,
              {std::move(waypoints), "Kinship recall", {}, time_s, time_s, recalled.checks});
  return true;
}

void report(Session& session, const Query& query, const MotionPlanRequest& request,
            MotionPlanResponse& response) {
  std::vector<double> waypoints;
  const auto& trajectory = trajectory_of(response);
  if (is_success(response) && trajectory != nullptr) {
    const auto* joints = trajectory->getGroup();
    for (std::size_t i = 0; joints != nullptr && i < trajectory->getWayPointCount(); ++i) {
      std::vector<double> q(joints->getVariableCount());
      trajectory->getWayPoint(i).copyJointGroupPositions(joints, q.data());
      waypoints.insert(waypoints.end(), q.begin(), q.end());
    }
    if (waypoints.size() % query.arm->dof() != 0)
      return;  // of another group
    if (waypoints.size() < 2 * query.arm->dof())
      return;  // the start was the goal: neither a path nor a failure
  }
  const double time_s = planning_time_of(response);
  post_report(session, query,
              {std::move(waypoints),
               request.planner_id.empty() ? "MoveIt" : request.planner_id,
               {},
               time_s,
               time_s,
               0});
}

}  // namespace kinship_moveit
