#pragma once

#include <random>
#include <string>

#include "robots/collision/collision_world.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "tests/support/robots.hpp"

/// A cell of 12 boxes (table, shelf of three by two compartments, four posts) in which a cobot
/// carries a box from the table into a compartment.
namespace kinship::bench {

struct ShelfCell {
  collision::Surroundings surroundings;
  Eigen::Isometry3d T_base_start = Eigen::Isometry3d::Identity();  ///< of the transfer frame
  Eigen::Isometry3d T_base_goal = Eigen::Isometry3d::Identity();
};

inline void place_box(ShelfCell& cell, const Eigen::Vector3d& center, const Eigen::Vector3d& size) {
  const std::string name = "box" + std::to_string(cell.surroundings.scene.objects.size());
  cell.surroundings.scene.objects.push_back(
      {name, BoxShape{size}, Eigen::Isometry3d(Eigen::Translation3d(center))});
}

/// A cell whose shelf, posts, start and goal vary by some centimetres. The base stands at the
/// origin, level with the table.
inline ShelfCell make_shelf_cell(const kinematics::Chain& chain, std::mt19937_64& generator) {
  std::normal_distribution<double> normal(0, 0.02);
  ShelfCell cell;
  const Eigen::Vector3d shelf(0.75 + normal(generator), -0.35 + normal(generator), 0);
  constexpr double kDepth = 0.3, kWidth = 0.6, kHeight = 0.3, kWall = 0.02;
  place_box(cell, {0.75, 0, -0.05}, {0.9, 1.4, 0.04});  // table
  for (int level = 0; level < 3; ++level)
    place_box(cell, shelf + Eigen::Vector3d(0, 0, 0.1 + level * kHeight), {kDepth, kWidth, kWall});
  for (const double side : {-0.5, 0.0, 0.5})
    place_box(cell, shelf + Eigen::Vector3d(0, side * kWidth, 0.1 + kHeight),
              {kDepth, kWall, 2 * kHeight});
  place_box(cell, shelf + Eigen::Vector3d(kDepth / 2, 0, 0.1 + kHeight),
            {kWall, kWidth, 2 * kHeight});  // back
  for (const double x : {0.35, 0.5, 0.65, 0.8})
    place_box(cell, {x + normal(generator), 0.12 + normal(generator), 0.17}, {0.05, 0.05, 0.4});

  AttachedObject held;
  held.name = "held";
  held.link = chain.tip_link();
  held.shape = BoxShape{{0.06, 0.06, 0.1}};
  held.T_link_object = chain.T_tip_transfer() * Eigen::Translation3d(0, 0, 0.07);
  cell.surroundings.attached.push_back(held);

  // Palm down over the table; palm forward into the right compartment of the lower row.
  cell.T_base_start.translation() << 0.5 + normal(generator), 0.4 + normal(generator), 0.2;
  cell.T_base_start.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  cell.T_base_goal.translation() = shelf + Eigen::Vector3d(-0.12, -kWidth / 4, 0.1 + kHeight / 2);
  cell.T_base_goal.rotate(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()));
  return cell;
}

/// Free configurations for a pose of the transfer frame, near mid-range.
inline Eigen::MatrixXd free_configurations(const kinematics::Chain& chain,
                                           collision::CollisionWorld& world,
                                           const Eigen::Isometry3d& T_base_transfer,
                                           const Eigen::VectorXd& around) {
  return planning::goal_configurations(chain, T_base_transfer,
                                       planning::planning_bounds(chain, around),
                                       [&](const Eigen::VectorXd& q) { return !world.collides(q); })
      .configurations;
}

inline geometry::RobotShapes model_shapes(const std::string& name) {
  return geometry::read_shapes(test::robot_model(name)).value_or_throw();
}

}  // namespace kinship::bench
