#include "client/experiments/station_problems.hpp"

#include <algorithm>
#include <optional>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "client/experiments/station_scene.hpp"
#include "client/experiments/studies/instance_draws.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/pose.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/inverse/inverse.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::experiments {

namespace {

constexpr double kStationTimeLimit_s =
    60;  // far beyond what the checks take: checks end a query first

/// What the links that move with the tip hold; links before the second joint stand on the table.
void add_contacts(const kinematics::Chain& chain, const StationScene& instance, Problem& problem) {
  problem.attached.push_back({instance.held_name, chain.tip_link(), instance.held,
                              chain.T_tip_transfer() * instance.T_transfer_held,
                              last_links(chain)});
  for (const kinematics::ChainLink& link : chain.links())
    if (link.joint < 1)
      problem.allowed_collisions.emplace_back(link.name, kTableName);
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

StationScene draw_scene(Station station, std::mt19937_64& generator) {
  return station == Station::Machine ? draw_machine_scene(generator) : draw_shelf_scene(generator);
}

/// The instance of one sub-seed; empty if the robot cannot start or end it.
std::optional<Problem> try_draw(Station station, const models::LoadedRobot& robot,
                                const Eigen::Isometry3d& T_task_base, const InstanceKey& key) {
  std::mt19937_64 scene_generator = generator_for(key, Use::Scene);
  const StationScene instance = draw_scene(station, scene_generator);
  Problem problem;
  problem.name = instance_name(to_text(station), key);
  problem.T_task_base = T_task_base;
  problem.scene = instance.scene;
  problem.T_task_goal = instance.T_task_place;
  problem.time_limit_s = kStationTimeLimit_s;
  problem.seed = planner_seed(key);
  add_contacts(robot.chain, instance, problem);

  std::mt19937_64 generator = generator_for(key, Use::Start);
  const auto start = free_configuration(robot, problem, instance.T_task_pick, generator);
  if (!start || !free_configuration(robot, problem, instance.T_task_place, generator))
    return std::nullopt;
  problem.start = *start;
  return problem;
}

}  // namespace

std::string_view to_text(Station station) {
  return station == Station::Machine ? "machine" : "shelf";
}

Eigen::Isometry3d placement_at(Station station, std::string_view label) {
  const bool at_machine = station == Station::Machine;
  double x = 0;
  if (label == "panda")
    x = at_machine ? -0.3 : -0.06;
  if (label == "iiwa14")
    x = at_machine ? -0.34 : -0.28;  // its elbow bends by 120 degrees at most
  if (label == "ur10e")
    x = at_machine ? -0.6 : -0.15;
  return upright(x, 0, 0);
}

Problem draw_station_problem(Station station, const models::LoadedRobot& robot,
                             const Eigen::Isometry3d& T_task_base, const InstanceKey& key) {
  return first_possible(
      key, kMaxDraws,
      "robot '" + robot.description.label +
          "' where it stands (is its placement right?) has no free start and goal in",
      std::string(to_text(station)),
      [&](const InstanceKey& draw) { return try_draw(station, robot, T_task_base, draw); });
}

void write_station_problems(const StationOptions& options, std::ostream& out,
                            std::ostream& messages) {
  const models::LoadedRobot robot = models::load_robot(options.robot).value_or_throw();
  const std::string& label = robot.description.label;
  const Eigen::Isometry3d T_task_base =
      options.T_task_base.value_or(placement_at(options.station, label));
  std::uint32_t redrawn = 0;
  for (std::uint32_t index = 0; index < options.count; ++index) {
    const Problem problem =
        draw_station_problem(options.station, robot, T_task_base, {options.seed, index, 0});
    if (problem.name.find('.') != std::string::npos)
      ++redrawn;
    out << json::to_json(problem) << '\n';
    if (!out)
      throw Failure(ErrorCode::Storage, "cannot write the problems");
  }
  messages << options.count << " problems for " << label << ", " << redrawn
           << " of them in a scene drawn again\n";
}

void write_placement(Station station, const models::RobotArguments& robot, std::ostream& out) {
  const RobotDescription description = models::describe_robot(robot).value_or_throw().description;
  const PoseArray pose = to_pose_array(placement_at(station, description.label));
  for (std::size_t i = 0; i < pose.size(); ++i)
    out << (i == 0 ? "" : " ") << pose[i];
  out << '\n';
}

}  // namespace kinship::experiments
