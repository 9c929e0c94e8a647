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

/// What who can read a robot's meshes tells of them to who cannot: solids that together hold them.
/// Approximate: what touches a mesh touches its solids, and what touches a solid may miss the mesh.
struct MeshSolids {
  std::vector<LinkSolid> solids;
  /// Pairs of link names that these solids say too little about to be compared: they touch too
  /// often where the meshes do not.
  std::vector<std::pair<std::string, std::string>> unfiltered;
};

/// The rule of the contract that the solids break, if any: names of 1 to kMaxLinkNameBytes of text,
/// sizes above 0 and at most kMaxPlacement_m, proper poses, at most
/// kMaxMeshSolids and kMaxCollisionPairs. The message begins with "mesh_solids".
std::optional<Error> check_mesh_solids(const MeshSolids& mesh_solids);

/// How well the geometry of a robot is known, the best last.
enum class GeometryGrade {
  None,         ///< no shapes: nothing is filtered
  Partial,      ///< of some links with meshes nothing is known
  Approximate,  ///< of some links solids around their meshes are known
  Exact,        ///< every link that has a shape is made of primitives
};

}  // namespace kinship
