#include <pluginlib/class_list_macros.hpp>
#include <pluginlib/class_loader.hpp>

#include "query.hpp"

namespace kinship_moveit {
namespace {

using planning_interface::PlanningContext;

/// Searches with libkinship: the query's goals, scene and guidance.
class OwnSearch {
 public:
  explicit OwnSearch(Session& session) : session_(session) {}

  /// \param is_over  asked before every check.
  void solve(const Query& query, const planning_scene::PlanningSceneConstPtr& scene,
             const MotionPlanRequest& request, const std::atomic<bool>& is_over,
             MotionPlanResponse& response) {
    error_code_of(response).val = ErrorCodes::PLANNING_FAILED;
    const KeptRegion kept =
        read_path_constraints(*scene, *query.start, request.path_constraints, query.arm->tip_link(),
                              query.T_task_world, to_pose(session_.settings().T_tip_transfer));
    const std::string untold = kept.untold.empty() ? why_not(query) : kept.untold;
    if (!untold.empty()) {
      RCLCPP_ERROR(session_.logger(), "Kinship cannot plan this: %s", untold.c_str());
      if (kept.untold.empty())
        error_code_of(response).val = ErrorCodes::INVALID_GOAL_CONSTRAINTS;
      return;
    }
    kinship_plan* found = nullptr;
    const kinship_code code = find(query, scene, request, kept, is_over, &found);
    if (code != KINSHIP_OK) {
      RCLCPP_ERROR(session_.logger(), "Kinship cannot plan this: %s", kinship_error_text());
      return;
    }
    const std::shared_ptr<const kinship_plan> plan(found, Release());
    auto info = sized<kinship_plan_info>();
    kinship_plan_describe(found, &info);
    planning_time_of(response) = info.planning_time_s;
    name_planner(response, std::string("Kinship ") + info.planner);
    if (info.is_stopped != 0) {
      error_code_of(response).val = ErrorCodes::PREEMPTED;
      return;
    }
    if (info.is_solved == 0) {
      RCLCPP_WARN(session_.logger(), "no path: %s", info.reason);
    } else {
      std::vector<double> waypoints(info.dof * info.waypoint_count);
      kinship_plan_copy(found, waypoints.data());
      trajectory_of(response) = valid_trajectory(query, scene, request, waypoints);
      error_code_of(response).val = trajectory_of(response) != nullptr
                                        ? ErrorCodes::SUCCESS
                                        : ErrorCodes::INVALID_MOTION_PLAN;
      if (trajectory_of(response) == nullptr)
        return;  // the scene knows more: nothing is reported
    }
    post_report(query, plan);
  }

 private:
  static std::string why_not(const Query& query) {
    if (!query.goals.has_any())
      return query.goals.untold.empty() ? "it has no goal" : query.goals.untold;
    if (query.arm->planner() == nullptr)
      return "the robot's files could not be read";
    return query.objects->untold();
  }

  kinship_code find(const Query& query, const planning_scene::PlanningSceneConstPtr& scene,
                    const MotionPlanRequest& request, const KeptRegion& kept,
                    const std::atomic<bool>& is_over, kinship_plan** plan) {
    std::vector<double> start(query.arm->dof());
    query.start->copyJointGroupPositions(
        scene->getRobotModel()->getJointModelGroup(request.group_name), start.data());
    auto around = sized<kinship_surroundings>();
    around.T_task_base = query.T_task_base.data();
    around.objects = query.objects->objects().data();
    around.object_count = query.objects->objects().size();
    around.allowed_collisions = query.objects->allowed().data();
    around.allowed_collision_pairs = query.objects->allowed().size() / 2;
    auto asked = sized<kinship_query>();
    asked.surroundings = &around;
    asked.dof = query.arm->dof();
    asked.start = start.data();
    asked.goals = query.goals.configurations.data();
    asked.goal_count = query.goals.configurations.size() / query.arm->dof();
    PoseNumbers T_task_goal{};
    if (asked.goal_count == 0) {
      T_task_goal = to_numbers(query.T_task_world * *query.goals.T_world_tip *
                               to_pose(session_.settings().T_tip_transfer));
      asked.T_task_goal = T_task_goal.data();
    }
    asked.region = kept.region ? &*kept.region : nullptr;
    asked.time_limit_s = request.allowed_planning_time;
    asked.seed = ++seed_;
    const std::string algorithm = algorithm_of(request);
    asked.algorithm = algorithm.empty() ? nullptr : algorithm.c_str();
    if (session_.settings().share != 0)  // below 0: as recommended
      asked.distribution = query.guidance.distribution.get();
    if (session_.settings().offers_recall && !std::exchange(query.was_recalled, true))
      asked.recall = query.guidance.recall.get();
    asked.share = session_.settings().share > 0 ? session_.settings().share : 0;
    asked.sampling = query.sampling;
    asked.stop = [](void* user) {
      return static_cast<const std::atomic<bool>*>(user)->load() ? 1 : 0;
    };
    asked.user = const_cast<std::atomic<bool>*>(&is_over);
    return kinship_plan_find(query.arm->planner().get(), &asked, plan);
  }

  /// A planner_id of Kinship; others, e.g. one of OMPL's configurations, are not for it.
  static std::string algorithm_of(const MotionPlanRequest& request) {
    for (const char* known : {"birrt", "cbirrt2", "roadmap", "rrtconnect"})
      if (request.planner_id == known)
        return known;
    return "";
  }

  void post_report(const Query& query, std::shared_ptr<const kinship_plan> plan) {
    if (!session_.settings().reports || std::exchange(query.is_reported, true))
      return;
    session_.post([&session = session_, task = query.task, plan] {
      if (kinship_plan_report(&session.client(), plan.get(), task.c_str(),
                              session.settings().machine.c_str()) != KINSHIP_OK)
        session.warn_once(std::string("a report is not kept: ") + kinship_error_text());
    });
  }

  static inline std::atomic<std::uint64_t> seed_ = 0;
  Session& session_;
};

/// One planning call: by Kinship's planners, or a stored path first and then another plugin.
class Context : public PlanningContext {
 public:
  /// \param query     null: without Kinship. \param is_own  begun for this context alone.
  /// \param other     null: Kinship's planners.
  Context(std::shared_ptr<Session> session, const std::string& group,
          std::shared_ptr<const Query> query, bool is_own,
          planning_interface::PlanningContextPtr other)
      : PlanningContext("kinship", group),
        session_(std::move(session)),
        query_(std::move(query)),
        is_own_(is_own),
        other_(std::move(other)) {}

  Solved solve(MotionPlanResponse& response) override {
    const bool is_solved = plan(response);
    return static_cast<Solved>(is_solved);
  }
  Solved solve(MotionPlanDetailedResponse& detailed) override {
    MotionPlanResponse response;
    const bool is_solved = plan(response);
    add_to(detailed, response);
    return static_cast<Solved>(is_solved);
  }
  bool terminate() override {
    is_over_ = true;
    return other_ == nullptr || other_->terminate();
  }
  void clear() override {
    is_over_ = false;
    if (other_ != nullptr)
      other_->clear();
  }

 private:
  bool plan(MotionPlanResponse& response) {
    if (query_ != nullptr && other_ == nullptr)
      OwnSearch(*session_).solve(*query_, planning_scene_, request_, is_over_, response);
    else if (other_ == nullptr)
      refuse(response);
    else if (query_ == nullptr ||
             !offer_recalled(*session_, *query_, planning_scene_, request_, response))
      other_->solve(response);
    if (is_own_ && query_ != nullptr && other_ != nullptr)
      report(*session_, *query_, request_, response);
    return is_success(response);
  }

  void refuse(MotionPlanResponse& response) {
    RCLCPP_ERROR(session_->logger(),
                 "Kinship cannot plan: its robot is still being read, or the request has no task "
                 "(kinship.task, or '@TASK' after the planner_id)");
    error_code_of(response).val = ErrorCodes::PLANNING_FAILED;
  }

  const std::shared_ptr<Session> session_;
  const std::shared_ptr<const Query> query_;
  const bool is_own_;
  const planning_interface::PlanningContextPtr other_;
  std::atomic<bool> is_over_ = false;
};

}  // namespace

/// Plans with Kinship's planners, or with those of `kinship.planner_plugin` after a stored path
/// was tried.
class PlannerManager : public planning_interface::PlannerManager {
 public:
  bool initialize(const moveit::core::RobotModelConstPtr& model,
                  const rclcpp::Node::SharedPtr& node, const std::string& ns) override {
    try {
      session_ = Session::open(node);
      if (session_ == nullptr)
        return false;
      const std::string& other = session_->settings().planner_plugin;
      if (other.empty()) {
        session_->want_planners();
      } else {
        loader_ = std::make_unique<Loader>("moveit_core", "planning_interface::PlannerManager");
        other_ = loader_->createSharedInstance(other);
        if (!other_->initialize(model, node, ns))
          return false;
      }
      for (const std::string& group : session_->settings().groups)
        session_->arm(*model, group);
      return true;
    } catch (const std::exception& error) {
      RCLCPP_ERROR(rclcpp::get_logger("kinship_moveit"), "%s", error.what());
      return false;
    }
  }

  std::string getDescription() const override {
    return other_ != nullptr ? "Kinship, then " + other_->getDescription() : "Kinship";
  }

  void getPlanningAlgorithms(std::vector<std::string>& algorithms) const override {
    if (other_ != nullptr)
      other_->getPlanningAlgorithms(algorithms);
    else
      algorithms = {"birrt", "cbirrt2", "roadmap", "rrtconnect"};
  }

  planning_interface::PlanningContextPtr getPlanningContext(
      const planning_scene::PlanningSceneConstPtr& scene, const MotionPlanRequest& request,
      ErrorCodes& error_code) const override {
    MotionPlanRequest plain = request;
    auto query = query_of_this_thread(scene);
    const bool is_own = query == nullptr;  // no adapter began it
    if (is_own)
      query = begin_query(*session_, scene, plain);
    planning_interface::PlanningContextPtr other;
    if (other_ != nullptr) {  // it makes its samplers now
      other = other_->getPlanningContext(scene, plain, error_code);
      if (other == nullptr)
        return nullptr;
    }
    if (is_own)
      end_query();
    auto context =
        std::make_shared<Context>(session_, request.group_name, std::move(query), is_own, other);
    context->setPlanningScene(scene);
    context->setMotionPlanRequest(plain);
    error_code.val = ErrorCodes::SUCCESS;
    return context;
  }

  bool canServiceRequest(const MotionPlanRequest& request) const override {
    if (other_ != nullptr)
      return other_->canServiceRequest(request);
    return request.trajectory_constraints.constraints.empty();
  }

  void setPlannerConfigurations(
      const planning_interface::PlannerConfigurationMap& configurations) override {
    config_settings_ = configurations;
    if (other_ != nullptr)
      other_->setPlannerConfigurations(configurations);
  }

 private:
  using Loader = pluginlib::ClassLoader<planning_interface::PlannerManager>;
  std::shared_ptr<Session> session_;
  std::unique_ptr<Loader> loader_;
  std::shared_ptr<planning_interface::PlannerManager> other_;  // unloaded before the loader
};

}  // namespace kinship_moveit

PLUGINLIB_EXPORT_CLASS(kinship_moveit::PlannerManager, planning_interface::PlannerManager)
