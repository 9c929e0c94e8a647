#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "client/experiments/studies/dear_scene.hpp"
#include "client/experiments/studies/furniture_scene.hpp"
#include "client/experiments/studies/instance_draws.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/planning/region_constraint.hpp"

namespace kinship::experiments {

namespace {

/// Whether the straight line from one configuration to another is free, both included.
bool is_straight_free(const Eigen::VectorXd& from, const Eigen::VectorXd& to, double step,
                      const planning::IsFree& is_free) {
  const int steps = static_cast<int>(std::ceil((to - from).norm() / step));
  for (int i = 0; i <= steps; ++i)
    if (!is_free(from + (to - from) * i / std::max(steps, 1)))
      return false;
  return true;
}

/// Draws the instances of one robot.
class DearInstances {
 public:
  DearInstances(DearKind kind, int max_goals, models::LoadedRobot robot, StudyRobot placed)
      : kind_(kind),
        max_goals_(max_goals),
        name_(study_name(kind)),
        robot_(std::move(robot)),
        placed_(std::move(placed)) {
    if (placed_.start.size() != robot_.chain.dof() || !robot_.chain.within_limits(placed_.start))
      throw Failure(ErrorCode::InvalidInput,
                    "robot '" + robot_.description.label + "' has no home in '" + name_ + "'");
  }

  Problem draw(std::uint64_t seed, std::uint32_t index) const {
    return first_possible({seed, index, 0}, kMaxDearDraws,
                          "robot '" + robot_.description.label + "' has no free start and goal in",
                          name_, [this](const InstanceKey& key) { return try_draw(key); });
  }

 private:
  Problem make_problem(const DearScene& instance) const {
    Problem problem;
    problem.time_limit_s = kTimeLimit_s;
    problem.T_task_base = placed_.T_task_base;
    problem.start = placed_.start;
    problem.T_task_goal = instance.T_task_goal;
    problem.scene = instance.scene;
    for (const HeldPart& part : instance.held)
      problem.attached.push_back({part.name, robot_.chain.tip_link(), part.shape,
                                  robot_.chain.T_tip_transfer() * part.T_transfer_part,
                                  last_links(robot_.chain)});
    for (const kinematics::ChainLink& link : robot_.chain.links())
      if (link.joint < 1)  // stands on the floor
        problem.allowed_collisions.emplace_back(link.name, kFloorName);
    if (kind_ == DearKind::Upright)
      problem.constraint = planning::upright_region(kDearTilt_rad);
    return problem;
  }

  /// \return empty if the robot cannot start or end the instance, or need not plan.
  std::optional<Problem> try_draw(const InstanceKey& key) const {
    // Each kind has random numbers of its own, and none of those of the furniture's kinds.
    constexpr std::uint64_t kSeedsOfAKind = 1'000'000, kFirstKind = 100;
    InstanceKey own = key;
    own.seed += kSeedsOfAKind * (static_cast<std::uint64_t>(kind_) + kFirstKind);
    std::mt19937_64 generator = generator_for(own, Use::Scene);
    const DearScene instance = draw_dear_scene(kind_, generator);
    Problem problem = make_problem(instance);
    problem.name = instance_name(name_, key);
    problem.seed = planner_seed(own);
    for (SceneCloud& cloud : problem.scene.clouds)
      cloud.cloud.file = problem.name + ".xyz";
    collision::CollisionWorld world(
        robot_.chain, robot_.shapes,
        {placed_.T_task_base, problem.scene, problem.attached, problem.allowed_collisions});
    const auto is_free = [&](const Eigen::VectorXd& q) { return !world.collides(q); };
    if (instance.T_task_start && !find_start(*instance.T_task_start, problem, is_free))
      return std::nullopt;
    if (!is_free(problem.start))
      return std::nullopt;
    const GoalPose goal{placed_.T_task_base.inverse() * instance.T_task_goal, max_goals_,
                        problem.seed};
    if (!has_free_goals(robot_.chain, goal, problem.start, is_free) ||
        needs_no_plan(problem, goal, is_free))
      return std::nullopt;
    return problem;
  }

  /// \return whether there is one that is free, the nearest to the home.
  bool find_start(const Eigen::Isometry3d& T_task_start, Problem& problem,
                  const planning::IsFree& is_free) const {
    planning::GoalOptions options;
    options.max_configurations = max_goals_;
    options.seed = problem.seed;
    const Eigen::MatrixXd found =
        planning::goal_configurations(robot_.chain, placed_.T_task_base.inverse() * T_task_start,
                                      planning::planning_bounds(robot_.chain, placed_.start),
                                      is_free, options)
            .configurations;
    Eigen::Index nearest = 0;
    if (found.cols() > 0)
      (found.colwise() - placed_.start).colwise().squaredNorm().minCoeff(&nearest);
    if (found.cols() > 0)
      problem.start = found.col(nearest);
    return found.cols() > 0;
  }

  bool needs_no_plan(const Problem& problem, const GoalPose& pose,
                     const planning::IsFree& is_free) const {
    constexpr double kLineStep = 0.05;  // joint units
    planning::GoalOptions options;
    options.max_configurations = pose.max_goals;
    options.seed = pose.seed;
    const planning::GoalConfigurations goals = planning::goal_configurations(
        robot_.chain, pose.T_base_transfer, planning::planning_bounds(robot_.chain, problem.start),
        is_free, options);
    for (const auto& goal : goals.configurations.colwise())
      if (is_straight_free(problem.start, goal, kLineStep, is_free))
        return true;
    return false;
  }

  const DearKind kind_;
  const int max_goals_;
  const std::string name_;
  const models::LoadedRobot robot_;
  const StudyRobot placed_;
};

}  // namespace

DrawInstance make_dear_instances(DearKind kind, int max_goals, const models::LoadedRobot& robot,
                                 const StudyRobot& placed) {
  // Shared by the copies of the function; immutable.
  const auto instances = std::make_shared<const DearInstances>(kind, max_goals, robot, placed);
  return
      [instances](std::uint64_t seed, std::uint32_t index) { return instances->draw(seed, index); };
}

}  // namespace kinship::experiments
