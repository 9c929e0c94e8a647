#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "proto/types/mesh_solids.hpp"
#include "proto/types/result.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::collision {

/// How a self-collision filter of fitted shapes compares with the meshes themselves, in random
/// configurations within the limits.
struct FilterAgreement {
  std::size_t free = 0, colliding = 0;  ///< configurations, as the meshes say
  std::size_t lost = 0;                 ///< of `free`: the filter takes them for collisions
  std::size_t found = 0;                ///< of `colliding`: the filter leaves them out too
  /// Links that the filter must not check against each other: those that are never checked with the
  /// meshes, and those whose fitted shapes touch too often where the meshes do not. Link indices,
  /// first < second, sorted.
  std::vector<std::pair<int, int>> unfiltered;
};

struct AgreementOptions {
  int samples = 1000;
  /// Of the free configurations the filter may lose this part at most: pairs of links are given up,
  /// those first that cost most free configurations for each collision they find, until it does.
  double max_lost = 0.05;
};

/// Chooses the pairs of links for a filter that knows fitted shapes only. A pair whose fitted
/// shapes touch at zero (moved into the limits), where no meshes touch, is given up too. Seeded:
/// equal input, equal answers. \param exact   with meshes as triangles. \param fitted  of the same
/// links: shapes that hold those meshes; its pairs are not looked at. \throws Failure(InvalidInput)
/// as RobotSolids says.
FilterAgreement choose_filtered_pairs(const kinematics::Chain& chain,
                                      const geometry::RobotShapes& exact,
                                      const geometry::RobotShapes& fitted,
                                      const AgreementOptions& options = {});

/// What a server is told of a robot's meshes, and how well that does.
struct FittedRobot {
  MeshSolids mesh_solids;  ///< none if the robot has no meshes
  FilterAgreement agreement;
};

/// \param shapes  with the meshes' triangles.
/// \return        what geometry::cover_links says.
/// \throws Failure(InvalidInput) as RobotSolids says.
Result<FittedRobot> fit_robot(const kinematics::Chain& chain, const geometry::RobotShapes& shapes);

}  // namespace kinship::collision
