#include <pluginlib/class_list_macros.hpp>

#include "query.hpp"

namespace kinship_moveit {

#if KINSHIP_MOVEIT_CHAINS_ADAPTERS

/// Begins a query of Kinship before the planners: task, placement, guidance.
class RequestAdapter : public planning_interface::PlanningRequestAdapter {
 public:
  void initialize(const rclcpp::Node::SharedPtr& node, const std::string&) override {
    session_ = Session::open(node);
  }
  std::string getDescription() const override { return "Kinship: begin guided query"; }
  moveit::core::MoveItErrorCode adapt(const planning_scene::PlanningSceneConstPtr& scene,
                                      MotionPlanRequest& request) const override {
    if (session_ != nullptr)
      begin_query(*session_, scene, request);
    return moveit::core::MoveItErrorCode::SUCCESS;
  }

 private:
  std::shared_ptr<Session> session_;
};

/// Reports the solution of this thread's query. MoveIt calls it for solved ones only.
class ResponseAdapter : public planning_interface::PlanningResponseAdapter {
 public:
  void initialize(const rclcpp::Node::SharedPtr& node, const std::string&) override {
    session_ = Session::open(node);
  }
  std::string getDescription() const override { return "Kinship: report solution"; }
  void adapt(const planning_scene::PlanningSceneConstPtr& scene, const MotionPlanRequest& request,
             MotionPlanResponse& response) const override {
    if (const auto query = query_of_this_thread(scene); query != nullptr && session_ != nullptr)
      report(*session_, *query, request, response);
    end_query();
  }

 private:
  std::shared_ptr<Session> session_;
};

#else

/// Begins a query of Kinship, offers a stored path before the planner, and reports what came of it.
class RequestAdapter : public planning_request_adapter::PlanningRequestAdapter {
 public:
  void initialize(const rclcpp::Node::SharedPtr& node, const std::string&) override {
    session_ = Session::open(node);
  }
  std::string getDescription() const override { return "Kinship: guide and report"; }
  bool adaptAndPlan(const PlannerFn& planner, const planning_scene::PlanningSceneConstPtr& scene,
                    const MotionPlanRequest& request, MotionPlanResponse& response,
                    std::vector<std::size_t>&) const override {
    if (session_ == nullptr)
      return planner(scene, request, response);
    MotionPlanRequest plain = request;
    const auto query = begin_query(*session_, scene, plain);
    if (query != nullptr && offer_recalled(*session_, *query, scene, plain, response)) {
      end_query();
      return true;
    }
    const bool is_solved = planner(scene, plain, response);
    if (query != nullptr)
      report(*session_, *query, plain, response);
    end_query();
    return is_solved;
  }

 private:
  std::shared_ptr<Session> session_;
};

#endif

}  // namespace kinship_moveit

#if KINSHIP_MOVEIT_CHAINS_ADAPTERS
PLUGINLIB_EXPORT_CLASS(kinship_moveit::RequestAdapter, planning_interface::PlanningRequestAdapter)
PLUGINLIB_EXPORT_CLASS(kinship_moveit::ResponseAdapter, planning_interface::PlanningResponseAdapter)
#else
PLUGINLIB_EXPORT_CLASS(kinship_moveit::RequestAdapter,
                       planning_request_adapter::PlanningRequestAdapter)
#endif
