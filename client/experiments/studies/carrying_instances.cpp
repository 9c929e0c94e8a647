#include "client/experiments/studies/carrying_instances.hpp"

#include <memory>
#include <optional>
#include <utility>

#include "client/experiments/studies/instance_draws.hpp"
#include "client/experiments/studies/instance_random.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/planning/region_constraint.hpp"

namespace kinship::experiments {
namespace {

/// Draws the instances of one robot.
class CarryingInstances {
 public:
  CarryingInstances(CarryingLayout layout, const models::LoadedRobot& robot,
                    const StudyRobot& placed)
      : layout_(std::move(layout)),
        robot_(robot),
        T_task_base_(placed.T_task_base),
        starts_(robot_.chain, placed.start.size() > 0 ? placed.start : find_nominal_start()) {}

  Problem draw(std::uint64_t seed, std::uint32_t index) const {
    return first_possible({seed, index, 0}, kMaxCarryingDraws,
                          "robot '" + robot_.description.label + "' has no free start and goals in",
                          layout_.name, [this](const InstanceKey& key) { return try_draw(key); });
  }

 private:
  Problem make_problem(const CarryingScene& instance) const {
    Problem problem;
    problem.T_task_base = T_task_base_;
    problem.time_limit_s = kTimeLimit_s;
    problem.scene = instance.scene;
    problem.constraint = planning::upright_region(layout_.tilt_rad);
    AttachedObject container{"container", robot_.chain.tip_link(), BoxShape{layout_.container},
                             robot_.chain.T_tip_transfer() * T_transfer_container(layout_),
                             last_links(robot_.chain)};
    problem.attached.push_back(std::move(container));
    return problem;
  }

  collision::CollisionWorld make_world(const Problem& problem) const {
    return {robot_.chain,
            robot_.shapes,
            {T_task_base_, problem.scene, problem.attached, problem.allowed_collisions}};
  }

  Eigen::VectorXd find_nominal_start() const {
    const CarryingScene nominal = nominal_carrying_scene(layout_);
    collision::CollisionWorld world = make_world(make_problem(nominal));
    std::optional<Eigen::VectorXd> best =
        find_middle_configuration(robot_.chain, T_task_base_.inverse() * nominal.T_task_pick,
                                  [&](const Eigen::VectorXd& q) { return !world.collides(q); });
    if (!best)
      throw Failure(ErrorCode::NotFound, "robot '" + robot_.description.label +
                                             "' has no free start in '" + layout_.name +
                                             "': is its placement right?");
    return *std::move(best);
  }

  /// Free configurations where a plan from the start may go: dof x n.
  Eigen::MatrixXd find_goals(const CarryingScene& instance, const Problem& problem,
                             collision::CollisionWorld& world) const {
    const Eigen::Matrix2Xd bounds = planning::planning_bounds(robot_.chain, problem.start);
    planning::GoalOptions options;
    options.max_configurations = 2 * layout_.goal_branches;
    options.min_distance = 0.5;
    std::vector<Eigen::MatrixXd> ways;
    for (const Eigen::Isometry3d& T_task_place : instance.T_task_places) {
      options.seed = problem.seed + ways.size();
      ways.push_back(planning::goal_configurations(
                         robot_.chain, T_task_base_.inverse() * T_task_place, bounds,
                         [&](const Eigen::VectorXd& q) { return !world.collides(q); }, options)
                         .configurations);
    }
    Eigen::MatrixXd goals(robot_.chain.dof(), layout_.goal_branches);
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < options.max_configurations; ++i)
      for (const Eigen::MatrixXd& way : ways)
        if (i < way.cols() && count < goals.cols())
          goals.col(count++) = way.col(i);
    return goals.leftCols(count);
  }

  /// \return empty if the robot cannot start or end the instance.
  std::optional<Problem> try_draw(const InstanceKey& key) const {
    std::mt19937_64 scene_generator = generator_for(key, Use::Scene);
    const CarryingScene instance = draw_carrying_scene(layout_, scene_generator);
    Problem problem = make_problem(instance);
    problem.name = instance_name(layout_.name, key);
    problem.seed = planner_seed(key);
    collision::CollisionWorld world = make_world(problem);
    std::mt19937_64 start_generator = generator_for(key, Use::Start);
    Noise start_noise(start_generator);
    const auto start = starts_.draw(T_task_base_.inverse() * instance.T_task_pick, start_noise,
                                    [&](const Eigen::VectorXd& q) { return !world.collides(q); });
    if (!start)
      return std::nullopt;
    problem.start = *start;
    problem.goal_configurations = find_goals(instance, problem, world);
    if (problem.goal_configurations.cols() < layout_.least_goal_branches)
      return std::nullopt;
    return problem;
  }

  const CarryingLayout layout_;
  const models::LoadedRobot robot_;
  const Eigen::Isometry3d T_task_base_;
  const StartDraws starts_;
};

}  // namespace

DrawInstance make_carrying_instances(const CarryingLayout& layout, const models::LoadedRobot& robot,
                                     const StudyRobot& placed) {
  // Shared by the copies of the function; immutable.
  const auto instances = std::make_shared<const CarryingInstances>(layout, robot, placed);
  return
      [instances](std::uint64_t seed, std::uint32_t index) { return instances->draw(seed, index); };
}

}  // namespace kinship::experiments
