#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "proto/types/link_mesh.hpp"
#include "proto/types/mesh_solids.hpp"
#include "proto/types/result.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::geometry {

/// Gives the content of a mesh by its digest; nothing: it is not here.
using FindMesh = std::function<std::optional<MeshContent>(const Digest& content)>;

/// The shapes of a robot known from its description and the contents of its meshes.
struct KnownShapes {
  RobotShapes shapes;  ///< never_colliding includes the pairs that the mesh solids exclude
  /// With the mesh solids in place of the meshes, which they hold: that is tested. Null without
  /// `mesh_links`, and if a mesh is not wholly in those of its link. Shared by copies; immutable.
  std::shared_ptr<const RobotShapes> covers = nullptr;
  bool are_covers_untested = false;  ///< null for the work that the test would have taken
  int exact_links = 0;               ///< made of primitives only
  int mesh_links = 0;                ///< with the triangles of all their meshes
  int approximate_links = 0;         ///< with a mesh known as solids around it
  int unknown_links = 0;             ///< with an unknown mesh: shapes may be missing
  int mesh_solids = 0;
  int unfiltered_pairs = 0;  ///< of links, excluded by the mesh solids
  GeometryGrade grade = GeometryGrade::None;
};

/// By the triangles of its meshes if those for collision of all links are here, else by its mesh
/// solids.
/// \param find  empty: no content is here.
/// \return also the errors of read_shapes; InvalidInput for mesh solids of a link that
///         is missing or has no mesh, and for an invalid size or pair.
Result<KnownShapes> read_known_shapes(const kinematics::RobotModel& robot,
                                      const FindMesh& find = {});

/// Whether a robot names as many meshes for collision as its URDF has, and at least one.
bool names_all_meshes(const kinematics::RobotModel& robot);

/// E.g. "7 links by exact shapes, 1 link by 3 solids around meshes (approximate; 2 pairs of links
/// not compared)".
std::string describe(const KnownShapes& known);

/// Solids around every mesh of a robot, for its description. robots/collision chooses the pairs not
/// to compare.
/// \param shapes  with the meshes' triangles, of the links of the chain.
/// \return        TooLarge above kMaxMeshSolids; InvalidInput for an invalid solid.
Result<MeshSolids> cover_links(const RobotShapes& shapes, const kinematics::Chain& chain);

/// The shapes with solids in place of meshes.
/// \param mesh_solids  of cover_links() for these shapes.
RobotShapes with_solids(const RobotShapes& shapes, const MeshSolids& mesh_solids,
                        const kinematics::Chain& chain);

}  // namespace kinship::geometry
