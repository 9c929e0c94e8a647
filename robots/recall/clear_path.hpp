#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <optional>
#include <random>

#include "robots/collision/body.hpp"
#include "robots/planning/is_free.hpp"
#include "robots/planning/region_constraint.hpp"

namespace kinship::recall {

/// The obstacles of a scene, each larger by a distance on every side, m. The robot, and what it
/// holds, stay as they are. Meshes and point clouds are left as they are.
collision::Surroundings enlarged(collision::Surroundings surroundings, double by_m);

/// Checks end plans of the server, not time: equal input, equal paths.
inline constexpr std::chrono::hours kNoTimeLimit{24};

struct ClearPathOptions {
  double step = 0.1;                    ///< between checked configurations, joint units
  std::uint64_t plan_checks = 50'000;   ///< at most, of planning around larger obstacles
  std::uint64_t polish_checks = 2'000;  ///< at most, of shortening there
  planning::RegionConstraint* constraint = nullptr;  ///< that the path keeps; null: none
};

/// A path with room around it: planned and shortened again where obstacles are larger, between the
/// first and the last configuration of the given path that are free there. The pieces before and
/// behind these stay as they are.
/// \param path      dof x n, free among the obstacles as they are; under a constraint at steps as
///                  those of plan_cbirrt2.
/// \param is_clear  whether a configuration is free among the larger obstacles.
/// \param bounds    2 x dof (planning_bounds).
/// \return nothing if the path begins too long within the larger obstacles, or no plan was found.
std::optional<Eigen::MatrixXd> clear_path(const Eigen::MatrixXd& path,
                                          const planning::IsFree& is_clear,
                                          const Eigen::Matrix2Xd& bounds,
                                          const ClearPathOptions& options,
                                          std::mt19937_64& generator);

/// The path at kRecallWaypoints configurations, equal parts of its length apart.
Eigen::MatrixXd equal_parts(const Eigen::MatrixXd& path);

}  // namespace kinship::recall
