#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "proto/types/scene.hpp"

namespace kinship {

/// A solid fitted around a collision mesh of a link, or around a part of it.
struct LinkSolid {
  std::string link;  ///< name in the URDF
  Shape shape;
  Eigen::Isometry3d T_link_shape = Eigen::Isometry3d::Identity();  ///< of the shape's centre
};

/// Solids that enclose a robot's meshes, from a client that can read the meshes, for programs that
/// cannot. Approximate: an object that touches a mesh touches its solids, but one that touches a
/// solid may miss the mesh.
struct MeshSolids {
  std::vector<LinkSolid> solids;
  /// Pairs of link names that are not compared with these solids: they touch too often where the
  /// meshes do not.
  std::vector<std::pair<std::string, std::string>> unfiltered;
};

/// The rule of the contract that the solids break, if any: names of 1 to kMaxLinkNameBytes of text,
/// sizes above 0 and at most kMaxPlacement_m, proper poses, at most
/// kMaxMeshSolids and kMaxCollisionPairs. The message begins with "mesh_solids".
std::optional<Error> check_mesh_solids(const MeshSolids& mesh_solids);

/// Quality of the known geometry of a robot, the best last.
enum class GeometryGrade {
  None,         ///< no shapes: no filtering
  Partial,      ///< some links with meshes have no known shape
  Approximate,  ///< some links have solids around their meshes
  Exact,        ///< every link with a shape is made of primitives
};

}  // namespace kinship
