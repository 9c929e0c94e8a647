#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pages/plots/drawn_robot.hpp"
#include "proto/types/attempt.hpp"
#include "robots/collision/collision_world.hpp"

namespace kinship::plots {

/// Places along a path that are looked at, at equal parts of its length in joint space.
inline constexpr Eigen::Index kPlacesOfPath = 201;

/// A path and how near to its surroundings and to itself the robot comes along it, by the shapes
/// that the server's description knows.
struct PathPlaces {
  std::vector<double> waypoints_at;  ///< part of the length before each waypoint, 0 to 1
  Eigen::Matrix3Xd hand;             ///< origin of the transfer frame in the task frame, m
  std::vector<collision::CollisionWorld::NearestPairs> nearest;  ///< one a place, like `hand`
  /// Pairs with an obstacle that stay at one distance, such as the foot of an arm above its table:
  /// told once, and not in `nearest`.
  std::vector<collision::CollisionWorld::NearestPair> steady;
  std::optional<std::size_t> nearest_obstacle, nearest_own;  ///< the place of the least one
  double length = 0;                                         ///< in joint space, joint units
  double hand_length_m = 0;                                  ///< of the hand's way
};

/// An attempt in its recorded scene: its path, if it has one, or what was in the way.
struct AttemptFigure {
  Attempt attempt;
  DrawnRobot drawn;
  std::optional<PathPlaces> path;
  std::vector<Eigen::Matrix3Xd> tree_hands;  ///< of each tree of its search record, as PathPlaces
  /// Pairs of names that are not compared, because they touch almost everywhere.
  std::vector<std::pair<std::string, std::string>> always_touching;
  std::vector<AttemptFigure> others;  ///< of the same query, see is_same_query(): drawn beside it
};

/// \param description  of the attempt's robot, as the server keeps it.
/// \throws Failure as drawn_robot; InvalidInput if it is of another robot.
AttemptFigure attempt_figure(Attempt attempt, const RobotDescription& description);

std::string to_json(const AttemptFigure& figure);

}  // namespace kinship::plots
