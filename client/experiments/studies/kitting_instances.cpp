#include "client/experiments/studies/kitting_instances.hpp"

#include <memory>
#include <optional>
#include <utility>

#include "client/experiments/studies/instance_draws.hpp"
#include "client/experiments/studies/instance_random.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"

namespace kinship::experiments {
namespace {

/// Draws the instances of one robot.
class KittingInstances {
 public:
  KittingInstances(int max_goals, const models::LoadedRobot& robot, const StudyRobot& placed)
      : max_goals_(max_goals),
        robot_(robot),
        T_task_base_(placed.T_task_base),
        starts_(robot_.chain, placed.start.size() > 0 ? placed.start : find_nominal_start()) {}

  Problem draw(std::uint64_t seed, std::uint32_t index) const {
    return first_possible({seed, index, 0}, kMaxKittingDraws,
                          "robot '" + robot_.description.label + "' has no free start and goal in",
                          "kitting", [this](const InstanceKey& key) { return try_draw(key); });
  }

 private:
  Problem make_problem(const KittingScene& instance) const {
    Problem problem;
    problem.time_limit_s = kTimeLimit_s;
    problem.T_task_base = T_task_base_;
    problem.T_task_goal = instance.T_task_place;
    problem.scene = instance.scene;
    problem.attached.push_back({"part", robot_.chain.tip_link(), kitting_part(),
                                robot_.chain.T_tip_transfer() * T_transfer_part(),
                                last_links(robot_.chain)});
    return problem;
  }

  collision::CollisionWorld make_world(const Problem& problem) const {
    return {robot_.chain, robot_.shapes, {T_task_base_, problem.scene, problem.attached, {}}};
  }

  Eigen::VectorXd find_nominal_start() const {
    std::mt19937_64 generator(0);
    KittingScene empty = draw_kitting_scene(0, generator);
    std::erase_if(empty.scene.objects,
                  [](const SceneObject& object) { return object.name.starts_with("part_"); });
    collision::CollisionWorld world = make_world(make_problem(empty));
    std::optional<Eigen::VectorXd> best =
        find_middle_configuration(robot_.chain, T_task_base_.inverse() * T_task_nominal_pick(),
                                  [&](const Eigen::VectorXd& q) { return !world.collides(q); });
    if (!best)
      throw Failure(ErrorCode::NotFound, "robot '" + robot_.description.label +
                                             "' has no free start in 'kitting': is its placement "
                                             "right?");
    return *std::move(best);
  }

  /// \return empty if the robot cannot start or end the instance.
  std::optional<Problem> try_draw(const InstanceKey& key) const {
    std::mt19937_64 scene_generator = generator_for(key, Use::Scene);
    const KittingScene instance =
        draw_kitting_scene(compartment_of(key.seed, key.index), scene_generator);
    Problem problem = make_problem(instance);
    problem.name = instance_name("kitting", key);
    problem.seed = planner_seed(key);
    collision::CollisionWorld world = make_world(problem);
    const auto is_free = [&](const Eigen::VectorXd& q) { return !world.collides(q); };
    std::mt19937_64 start_generator = generator_for(key, Use::Start);
    Noise start_noise(start_generator);
    const auto start =
        starts_.draw(T_task_base_.inverse() * instance.T_task_pick, start_noise, is_free);
    const GoalPose goal{T_task_base_.inverse() * instance.T_task_place, max_goals_, problem.seed};
    if (!start || !has_free_goals(robot_.chain, goal, *start, is_free))
      return std::nullopt;
    problem.start = *start;
    return problem;
  }

  const int max_goals_;
  const models::LoadedRobot robot_;
  const Eigen::Isometry3d T_task_base_;
  const StartDraws starts_;
};

}  // namespace

DrawInstance make_kitting_instances(int max_goals, const models::LoadedRobot& robot,
                                    const StudyRobot& placed) {
  // Shared by the copies of the function; immutable.
  const auto instances = std::make_shared<const KittingInstances>(max_goals, robot, placed);
  return
      [instances](std::uint64_t seed, std::uint32_t index) { return instances->draw(seed, index); };
}

}  // namespace kinship::experiments
