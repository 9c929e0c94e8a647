#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <random>
#include <string>

#include "client/planning/goal_configurations.hpp"
#include "client/planning/planning_bounds.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/inverse/inverse.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/robots.hpp"

/// A planar cell of three boxes: a planar arm carries a box from beside one of them into the slot
/// between the other two. Boxes, start and goal vary by some centimetres.
namespace kinship::bench {

struct PlanarRobot {
  explicit PlanarRobot(const std::string& name)
      : chain(test::model_chain(name)),
        shapes(geometry::read_shapes(test::model_description(name), chain).value_or_throw()),
        descent(chain) {}

  kinematics::Chain chain;
  geometry::RobotShapes shapes;
  inverse::Descent descent;
};

struct PlanarCell {
  collision::Surroundings surroundings;
  Eigen::Isometry3d T_base_start = Eigen::Isometry3d::Identity();  ///< of the transfer frame
  Eigen::Isometry3d T_base_goal = Eigen::Isometry3d::Identity();
};

/// The cell of a seed; without a seed as it is drawn, nothing moved.
inline PlanarCell make_planar_cell(const kinematics::Chain& chain,
                                   std::optional<std::uint64_t> seed) {
  std::mt19937_64 generator(seed.value_or(0));
  std::normal_distribution<double> normal(0, 1);
  const auto noise = [&](double deviation) { return seed ? deviation * normal(generator) : 0.0; };
  PlanarCell cell;
  const auto place = [&](double x, double y, double half_x, double half_y, double angle) {
    cell.surroundings.scene.objects.push_back(
        {"box" + std::to_string(cell.surroundings.scene.objects.size()),
         BoxShape{{2 * half_x, 2 * half_y, 0.2}},
         test::planar_pose(x + noise(0.02), y + noise(0.02), angle + noise(0.04))});
  };
  place(0.62, 0.105, 0.2, 0.04, 0);
  place(0.62, -0.105, 0.2, 0.04, 0);
  place(0.30, 0.42, 0.12, 0.05, -0.6);
  cell.T_base_start = test::planar_pose(0.12 + noise(0.02), 0.72 + noise(0.02), 1.3 + noise(0.06));
  cell.T_base_goal = test::planar_pose(0.62 + noise(0.01), noise(0.01), noise(0.04));
  AttachedObject held;
  held.name = "held";
  held.link = chain.tip_link();
  held.shape = BoxShape{{0.06, 0.08, 0.06}};
  held.T_link_object = chain.T_tip_transfer();
  for (const kinematics::ChainLink& link : chain.links())
    if (link.joint >= static_cast<int>(chain.dof()) - 2)
      held.touch_links.push_back(link.name);
  cell.surroundings.attached.push_back(held);
  return cell;
}

/// A planning query in a cell.
struct PlanarQuery {
  Eigen::VectorXd start;
  Eigen::MatrixXd goals;
};

/// The free configuration at the start pose of the cell as drawn that is nearest to the middle.
inline Eigen::VectorXd nominal_start(const PlanarRobot& robot) {
  const PlanarCell cell = make_planar_cell(robot.chain, std::nullopt);
  collision::CollisionWorld world(robot.chain, robot.shapes, cell.surroundings);
  const Eigen::MatrixXd found =
      inverse::inverse(robot.chain, cell.T_base_start * robot.chain.T_tip_transfer().inverse(),
                       {.max_solutions = 500, .min_distance = 0.2})
          .configurations;
  Eigen::VectorXd best;
  for (Eigen::Index i = 0; i < found.cols(); ++i)
    if (!world.collides(found.col(i)) && (best.size() == 0 || found.col(i).norm() < best.norm()))
      best = found.col(i);
  return best;
}

/// The query of a seed in its cell: a start near the nominal one, up to eight goal branches.
/// Nothing if the start pose cannot be taken there.
inline std::optional<PlanarQuery> make_query(const PlanarRobot& robot, const PlanarCell& cell,
                                             collision::CollisionWorld& world,
                                             const Eigen::VectorXd& nominal, std::uint64_t seed) {
  std::mt19937_64 generator(seed * 31 + 7);
  std::normal_distribution<double> normal(0, 0.1);
  for (int attempt = 0; attempt < 20; ++attempt) {
    inverse::JointVector q = nominal;
    for (Eigen::Index j = 0; j < q.size(); ++j)
      q[j] += normal(generator);
    robot.descent.run(cell.T_base_start, inverse::Descent::Limits::Steer, 30, q);
    if (!robot.chain.within_limits(q) || !inverse::reaches(robot.chain, cell.T_base_start, q) ||
        world.collides(q))
      continue;
    PlanarQuery query{q, {}};
    query.goals =
        planning::goal_configurations(
            robot.chain, cell.T_base_goal, planning::planning_bounds(robot.chain, query.start),
            [&](const Eigen::VectorXd& goal) { return !world.collides(goal); },
            {.max_configurations = 8, .min_distance = 0.5, .seed = seed})
            .configurations;
    if (query.goals.cols() == 0)
      return std::nullopt;
    return query;
  }
  return std::nullopt;
}

}  // namespace kinship::bench
