#include "client/experiments/shelf_problems.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <random>
#include <vector>

#include "client/experiments/shelf_scene.hpp"
#include "client/experiments/studies/instance_random.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/inverse/inverse.hpp"

namespace kinship::experiments {
namespace {

constexpr double kShelfTimeLimit_s =
    60;  // far beyond what the checks take: checks end a query first

/// Links that move with the tip hold the box; links before the second joint stand on the table.
void add_touching_links(const kinematics::Chain& chain, AttachedObject& box, Problem& problem) {
  const int last = static_cast<int>(chain.dof()) - 1;
  for (const kinematics::ChainLink& link : chain.links()) {
    if (link.joint == last)
      box.touch_links.push_back(link.name);
    if (link.joint < 1)
      problem.allowed_collisions.emplace_back(link.name, kTableName);
  }
}

/// Configurations of the transfer frame's pose, in random order.
std::vector<Eigen::VectorXd> configurations_at(const kinematics::Chain& chain,
                                               const Eigen::Isometry3d& T_base_transfer,
                                               std::mt19937_64& generator) {
  inverse::InverseOptions options;
  options.max_solutions = 12;
  options.min_distance = 0.5;
  options.seed = generator();
  const Eigen::Isometry3d T_base_tip = T_base_transfer * chain.T_tip_transfer().inverse();
  const auto solutions = inverse::inverse(chain, T_base_tip, options);
  std::vector<Eigen::VectorXd> configurations;
  for (const auto& q : solutions.configurations.colwise())
    configurations.emplace_back(q);
  std::shuffle(configurations.begin(), configurations.end(), generator);
  return configurations;
}

/// The first free one of the configurations at a pose.
std::optional<Eigen::VectorXd> free_configuration(const models::LoadedRobot& robot,
                                                  const Problem& problem,
                                                  const Eigen::Isometry3d& T_task_transfer,
                                                  std::mt19937_64& generator) {
  collision::CollisionWorld world(
      robot.chain, robot.shapes,
      {*problem.T_task_base, problem.scene, problem.attached, problem.allowed_collisions});
  const Eigen::Isometry3d T_base_transfer = problem.T_task_base->inverse() * T_task_transfer;
  for (const Eigen::VectorXd& q : configurations_at(robot.chain, T_base_transfer, generator))
    if (!world.collides(q))
      return q;
  return std::nullopt;
}

/// The instance of one sub-seed; empty if the robot cannot start or end it.
std::optional<Problem> try_draw(const models::LoadedRobot& robot,
                                const Eigen::Isometry3d& T_task_base, const InstanceKey& key) {
  std::mt19937_64 scene_generator = generator_for(key, Use::Scene);
  const ShelfScene instance = draw_shelf_scene(scene_generator);
  Problem problem;
  problem.name = instance_name("shelf", key);
  problem.T_task_base = T_task_base;
  problem.scene = instance.scene;
  problem.T_task_goal = instance.T_task_place;
  problem.time_limit_s = kShelfTimeLimit_s;
  problem.seed = planner_seed(key);
  AttachedObject box{"box",
                     robot.chain.tip_link(),
                     held_box(),
                     robot.chain.T_tip_transfer() * T_transfer_box(),
                     {}};
  add_touching_links(robot.chain, box, problem);
  problem.attached.push_back(box);

  std::mt19937_64 generator = generator_for(key, Use::Start);
  const auto start = free_configuration(robot, problem, instance.T_task_pick, generator);
  if (!start || !free_configuration(robot, problem, instance.T_task_place, generator))
    return std::nullopt;
  problem.start = *start;
  return problem;
}

}  // namespace

Eigen::Isometry3d shelf_placement(std::string_view label) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  if (label == "panda")
    T.translation().x() = -0.06;
  if (label == "iiwa14")
    T.translation().x() = -0.28;  // its elbow bends by 120 degrees at most
  if (label == "ur10e")
    T.translation().x() = -0.15;
  return T;
}

Problem draw_shelf_problem(const models::LoadedRobot& robot, const Eigen::Isometry3d& T_task_base,
                           std::uint64_t seed, std::uint32_t index) {
  for (std::uint32_t draw = 0; draw < kMaxDraws; ++draw)
    if (std::optional<Problem> problem = try_draw(robot, T_task_base, {seed, index, draw}))
      return *std::move(problem);
  throw Failure(ErrorCode::NotFound,
                "robot '" + robot.description.label + "' has no free start and goal in " +
                    std::to_string(kMaxDraws) + " draws of " +
                    instance_name("shelf", {seed, index, 0}) + ": is its placement right?");
}

}  // namespace kinship::experiments
