#include "client/experiments/studies/planar_scene.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "client/experiments/studies/instance_draws.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/inverse/solver.hpp"

namespace kinship::experiments {
namespace {

constexpr double kHeight_m = 0.1;  // of everything, so that a plane becomes a space
constexpr double kCarriedLength_m = 0.06, kCarriedWidth_m = 0.08;

constexpr double kBoxNoise_m = 0.02, kBoxNoise_rad = 0.04;
constexpr double kStartNoise_m = 0.02, kStartNoise_rad = 0.06;
constexpr double kGoalNoise_m = 0.01, kGoalNoise_rad = 0.04;

Eigen::Isometry3d in_space(const PlanarPose& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << pose.x, pose.y, 0;
  T.linear() = Eigen::AngleAxisd(pose.yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

PlanarPose noisy(const PlanarPose& pose, double noise_m, double noise_rad, Noise& noise) {
  PlanarPose moved = pose;
  moved.x += noise(noise_m);
  moved.y += noise(noise_m);
  moved.yaw_rad += noise(noise_rad);
  return moved;
}

PlanarLayout noisy(const PlanarLayout& layout, Noise& noise) {
  PlanarLayout moved = layout;
  for (PlanarBox& box : moved.boxes)
    box.pose = noisy(box.pose, kBoxNoise_m, kBoxNoise_rad, noise);
  moved.start = noisy(layout.start, kStartNoise_m, kStartNoise_rad, noise);
  moved.goal = noisy(layout.goal, kGoalNoise_m, kGoalNoise_rad, noise);
  return moved;
}

/// Draws the instances of one arm.
class PlanarInstances {
 public:
  PlanarInstances(PlanarLayout layout, const models::LoadedRobot& robot, const StudyRobot& placed)
      : layout_(std::move(layout)),
        robot_(robot),
        T_task_base_(placed.T_task_base),
        solver_(robot_.chain),
        starts_(robot_.chain, placed.start.size() > 0 ? placed.start : find_nominal_start()) {}

  Problem draw(std::uint64_t seed, std::uint32_t index) const {
    return first_possible({seed, index, 0}, kMaxPlanarDraws,
                          "robot '" + robot_.description.label + "' has no free start and goal in",
                          layout_.name, [this](const InstanceKey& key) { return try_draw(key); });
  }

 private:
  /// \param spare_m  by which the carried box is larger than it is, on each side.
  Problem make_problem(const PlanarLayout& layout, double spare_m = 0) const {
    Problem problem;
    problem.T_task_base = T_task_base_;
    problem.time_limit_s = kTimeLimit_s;
    for (std::size_t i = 0; i < layout.boxes.size(); ++i) {
      const PlanarBox& box = layout.boxes[i];
      problem.scene.objects.push_back({"box_" + std::to_string(i + 1),
                                       BoxShape{{2 * box.half_x, 2 * box.half_y, kHeight_m}},
                                       in_space(box.pose)});
    }
    AttachedObject carried{
        "carried", robot_.chain.tip_link(),
        BoxShape{{kCarriedLength_m + 2 * spare_m, kCarriedWidth_m + 2 * spare_m, kHeight_m}},
        robot_.chain.T_tip_transfer(), last_links(robot_.chain)};
    problem.attached.push_back(std::move(carried));
    problem.T_task_goal = in_space(layout.goal);
    return problem;
  }

  collision::CollisionWorld make_world(const Problem& problem) const {
    return {robot_.chain, robot_.shapes, {T_task_base_, problem.scene, problem.attached, {}}};
  }

  Eigen::MatrixXd configurations_at(const PlanarPose& pose, int count, std::uint64_t seed) const {
    inverse::InverseOptions options;
    options.max_solutions = count;
    options.min_distance = 0.3;
    options.seed = seed;
    const Eigen::Isometry3d T_base_tip =
        T_task_base_.inverse() * in_space(pose) * robot_.chain.T_tip_transfer().inverse();
    return solver_.solve(T_base_tip, options).configurations;
  }

  /// The free configuration nearest to the stretched arm.
  Eigen::VectorXd find_nominal_start() const {
    constexpr int kCandidates = 500;
    collision::CollisionWorld world = make_world(make_problem(layout_));
    std::optional<Eigen::VectorXd> best;
    const Eigen::MatrixXd candidates = configurations_at(layout_.start, kCandidates, 0);
    for (const auto& q : candidates.colwise())
      if ((!best || q.norm() < best->norm()) && !world.collides(q))
        best = q;
    if (!best)
      throw Failure(ErrorCode::NotFound, "robot '" + robot_.description.label +
                                             "' has no free start in '" + layout_.name +
                                             "': is its placement right?");
    return *std::move(best);
  }

  bool has_free_goal(const PlanarLayout& layout, std::uint64_t seed) const {
    constexpr int kCandidates = 20;
    collision::CollisionWorld world = make_world(make_problem(layout, layout.spare_m));
    const Eigen::MatrixXd candidates = configurations_at(layout.goal, kCandidates, seed);
    for (const auto& q : candidates.colwise())
      if (!world.collides(q))
        return true;
    return false;
  }

  /// \return empty if the arm cannot start or end the instance.
  std::optional<Problem> try_draw(const InstanceKey& key) const {
    std::mt19937_64 scene_generator = generator_for(key, Use::Scene);
    Noise scene_noise(scene_generator);
    const PlanarLayout layout = noisy(layout_, scene_noise);
    Problem problem = make_problem(layout);
    problem.name = instance_name(layout_.name, key);
    problem.seed = planner_seed(key);
    collision::CollisionWorld world = make_world(problem);
    std::mt19937_64 start_generator = generator_for(key, Use::Start);
    Noise start_noise(start_generator);
    const auto start = starts_.draw(T_task_base_.inverse() * in_space(layout.start), start_noise,
                                    [&](const Eigen::VectorXd& q) { return !world.collides(q); });
    if (!start || !has_free_goal(layout, problem.seed))
      return std::nullopt;
    problem.start = *start;
    return problem;
  }

  const PlanarLayout layout_;
  const models::LoadedRobot robot_;
  const Eigen::Isometry3d T_task_base_;
  const inverse::Solver solver_;
  const StartDraws starts_;
};

}  // namespace

DrawInstance make_planar_instances(const PlanarLayout& layout, const models::LoadedRobot& robot,
                                   const StudyRobot& placed) {
  // Shared by the copies of the function; immutable.
  const auto instances = std::make_shared<const PlanarInstances>(layout, robot, placed);
  return
      [instances](std::uint64_t seed, std::uint32_t index) { return instances->draw(seed, index); };
}

}  // namespace kinship::experiments
