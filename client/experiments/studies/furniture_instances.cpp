#include "client/experiments/studies/furniture_instances.hpp"

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "client/experiments/studies/instance_draws.hpp"
#include "client/experiments/studies/instance_random.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"

namespace kinship::experiments {
namespace {

/// Draws the instances of one robot.
class FurnitureInstances {
 public:
  FurnitureInstances(FurnitureKind kind, int max_goals, models::LoadedRobot robot,
                     StudyRobot placed)
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
    return first_possible({seed, index, 0}, kMaxFurnitureDraws,
                          "robot '" + robot_.description.label + "' has no free start and goal in",
                          name_, [this](const InstanceKey& key) { return try_draw(key); });
  }

 private:
  /// \return empty if the robot cannot start or end the instance.
  std::optional<Problem> try_draw(const InstanceKey& key) const {
    // Each kind has random numbers of its own: no two kinds stand alike.
    constexpr std::uint64_t kSeedsOfAKind = 1'000'000;
    InstanceKey own = key;
    own.seed += kSeedsOfAKind * (static_cast<std::uint64_t>(kind_) + 1);
    std::mt19937_64 generator = generator_for(own, Use::Scene);
    const FurnitureScene instance = draw_furniture_scene(kind_, generator);
    Problem problem;
    problem.name = instance_name(name_, key);
    problem.seed = planner_seed(own);
    problem.time_limit_s = kTimeLimit_s;
    problem.T_task_base = placed_.T_task_base;
    problem.start = placed_.start;
    problem.T_task_goal = instance.T_task_grasp;
    problem.scene = instance.scene;
    for (const kinematics::ChainLink& link : robot_.chain.links())
      if (link.joint < 1)  // stands on the floor
        problem.allowed_collisions.emplace_back(link.name, kFloorName);
    collision::CollisionWorld world(
        robot_.chain, robot_.shapes,
        {problem.T_task_base.value(), problem.scene, {}, problem.allowed_collisions});
    const GoalPose goal{placed_.T_task_base.inverse() * instance.T_task_grasp, max_goals_,
                        problem.seed};
    if (world.collides(problem.start) ||
        !has_free_goals(robot_.chain, goal, problem.start,
                        [&](const Eigen::VectorXd& q) { return !world.collides(q); }))
      return std::nullopt;
    return problem;
  }

  const FurnitureKind kind_;
  const int max_goals_;
  const std::string name_;
  const models::LoadedRobot robot_;
  const StudyRobot placed_;
};

}  // namespace

DrawInstance make_furniture_instances(FurnitureKind kind, int max_goals,
                                      const models::LoadedRobot& robot, const StudyRobot& placed) {
  // Shared by the copies of the function; immutable.
  const auto instances = std::make_shared<const FurnitureInstances>(kind, max_goals, robot, placed);
  return
      [instances](std::uint64_t seed, std::uint32_t index) { return instances->draw(seed, index); };
}

}  // namespace kinship::experiments
