#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "proto/types/mesh_solids.hpp"
#include "proto/types/result.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::collision {

/// Agreement of a self-collision filter of fitted shapes with the meshes themselves, in random
/// configurations within the limits.
struct FilterAgreement {
  std::size_t free = 0, colliding = 0;  ///< configurations, by the meshes
  std::size_t lost = 0;                 ///< of `free`: the filter rejects them as collisions
  std::size_t found = 0;                ///< of `colliding`: the filter rejects them too
  /// Links that the filter must not check against each other: links that are never checked with the
  /// meshes, and links whose fitted shapes touch too often where the meshes do not. Link indices,
  /// first < second, sorted.
  std::vector<std::pair<int, int>> unfiltered;
};

struct AgreementOptions {
  int samples = 1000;
  /// Largest part of the free configurations that the filter may lose: pairs of links are dropped,
  /// first those that cost most free configurations per collision found, until it is met.
  double max_lost = 0.05;
};

/// Chooses the pairs of links for a filter that knows fitted shapes only. A pair whose fitted
/// shapes touch at zero (moved into the limits), where no meshes touch, is dropped too. Seeded:
/// equal input, equal answers.
/// \param exact   with meshes as triangles.
/// \param fitted  of the same links: shapes that hold the meshes; its pairs are ignored.
/// \throws Failure(InvalidInput) as RobotSolids.
FilterAgreement choose_filtered_pairs(const kinematics::Chain& chain,
                                      const geometry::RobotShapes& exact,
                                      const geometry::RobotShapes& fitted,
                                      const AgreementOptions& options = {});

/// The solids around a robot's meshes for the server, and their agreement with the meshes.
struct FittedRobot {
  MeshSolids mesh_solids;  ///< none if the robot has no meshes
  FilterAgreement agreement;
};

/// \param shapes  with the meshes' triangles.
/// \return        the solids, or the error of geometry::cover_links.
/// \throws Failure(InvalidInput) as RobotSolids.
Result<FittedRobot> fit_robot(const kinematics::Chain& chain, const geometry::RobotShapes& shapes);

}  // namespace kinship::collision
