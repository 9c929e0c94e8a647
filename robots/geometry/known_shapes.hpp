#pragma once

#include <string>

#include "proto/types/mesh_solids.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::geometry {

/// What of a robot is known to who has its description only, and cannot read its meshes.
struct KnownShapes {
  RobotShapes shapes;   ///< never_colliding has the pairs that the mesh solids say too little about
  int exact_links = 0;  ///< made of primitives only
  int approximate_links = 0;  ///< of which a mesh is known as solids around it
  int unknown_links = 0;      ///< of which a mesh is not known: shapes of theirs may be missing
  int mesh_solids = 0;
  int unfiltered_pairs = 0;  ///< of links, that the mesh solids say too little about
  GeometryGrade grade = GeometryGrade::None;
};

/// \return what read_shapes says of the URDF; InvalidInput for mesh solids of a link that is not
///         there or has no mesh, and for a size or pair that is none.
Result<KnownShapes> read_known_shapes(const RobotDescription& description,
                                      const kinematics::Chain& chain);

/// E.g. "7 links by exact shapes, 1 by 3 solids around its meshes (approximate; 2 pairs of links
/// are not compared), 0 unknown".
std::string describe(const KnownShapes& known);

/// Solids around every mesh of a robot, for its description. Pairs that are not to be compared are
/// for robots/collision to say.
/// \param shapes  with the meshes' triangles, of the links of the chain.
/// \return        TooLarge above kMaxMeshSolids; InvalidInput for a solid that is none.
Result<MeshSolids> cover_links(const RobotShapes& shapes, const kinematics::Chain& chain);

/// The shapes with solids in the place of meshes.
/// \param mesh_solids  made of them by cover_links().
RobotShapes with_solids(const RobotShapes& shapes, const MeshSolids& mesh_solids,
                        const kinematics::Chain& chain);

}  // namespace kinship::geometry
