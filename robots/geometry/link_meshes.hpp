#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "proto/types/link_mesh.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::geometry {

/// The meshes of a robot as it sends them to a server.
struct LinkMeshes {
  std::vector<LinkMesh> meshes;
  std::vector<MeshContent> contents;  ///< of the meshes, each once
  /// Meshes that stay here, and why, and visuals that were simplified: a sentence each, without a
  /// full stop.
  std::vector<std::string> notes;
};

/// Reads the meshes of a robot's links. One that cannot be read or is over a cap of the contract
/// stays here; visuals above kMaxVisualTriangles are simplified, meshes for collision never.
/// Collision goes first where a robot's caps do not hold all.
/// \param robot   with its URDF.
/// \param meshes  of the URDF's names; its errors become notes.
LinkMeshes read_link_meshes(const kinematics::RobotModel& robot, const MeshSource& meshes);

/// A mesh with fewer triangles, and the largest distance of a point of it from the mesh that it was
/// made of. Parts smaller than that may be missing.
struct SimplifiedMesh {
  Eigen::Matrix3Xd corners;  ///< 3 x 3 n, m, three columns a triangle
  double error_m = 0;
};

/// Merges the vertices in each cube of a grid, the finest that leaves at most `most` triangles.
/// \param corners  3 x 3 n, m, three columns a triangle, n >= 1, finite.
/// \param most     at least 4; a mesh that has no more comes back as it is.
/// Source: Rossignac and Borrel, Multi-resolution 3D approximations for rendering complex scenes
/// (1993).
SimplifiedMesh simplify(const Eigen::Matrix3Xd& corners, std::size_t most);

}  // namespace kinship::geometry
