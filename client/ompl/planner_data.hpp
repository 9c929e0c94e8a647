#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "proto/types/path.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::ompl_planners {

/// The ways of a roadmap or of trees from their starts to their goals.
struct RoadmapPaths {
  std::vector<Path> paths;         ///< the shortest from each start to each goal that it reaches
  std::size_t without_way = 0;     ///< goals that no start reaches
  std::size_t other_vertices = 0;  ///< that are on none of these paths
};

/// Reads a file of ompl::base::PlannerDataStorage. An edge by itself was the answer to no query:
/// only ways from a start to a goal are taken. Edges count in both directions, with the distance
/// of their configurations as length. A planner that checks edges late (LazyPRM) may have stored
/// some that collide.
///
/// The states are those of a RealVectorStateSpace of the chain's joints, or of MoveIt's group of
/// these: there edges of continuous joints go the shorter way, so a path may leave the turn that
/// MoveIt wraps them into. The format is Boost's, which believes what it reads: only for files that
/// one trusts. \throws Failure(NotFound, InvalidInput) that names the file; Failure(TooLarge) above
///         kMaxRoadmapPaths paths.
RoadmapPaths read_planner_data(const std::filesystem::path& file, const kinematics::Chain& chain);

inline constexpr std::size_t kMaxRoadmapPaths = 10'000;

}  // namespace kinship::ompl_planners
