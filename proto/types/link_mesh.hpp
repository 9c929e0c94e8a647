#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/result.hpp"

namespace kinship {

/// What a link's mesh is for.
enum class MeshRole { Visual, Collision, Both };

/// A mesh of a robot's link, by its content: the URDF's scale is in its vertices.
struct LinkMesh {
  std::string link;  ///< name in the URDF
  MeshRole role = MeshRole::Both;
  Eigen::Isometry3d T_link_mesh = Eigen::Isometry3d::Identity();
  std::vector<double> rgba = {};  ///< of the URDF's material, 0 to 1; empty: none
  /// Bound of the distance between this mesh and the one of the URDF, m; 0: as it is, but for
  /// vertices rounded to 32 bits. Always 0 of a mesh for collision.
  double error_m = 0;
  Digest content = {};  ///< see TriangleMesh::digest()
};

inline bool is_visual(const LinkMesh& mesh) { return mesh.role != MeshRole::Collision; }
inline bool is_collision(const LinkMesh& mesh) { return mesh.role != MeshRole::Visual; }

/// The rule of the contract that a robot's meshes break, if any: at most kMaxLinkMeshes, names of 1
/// to kMaxLinkNameBytes of text, proper poses, colours of none or four numbers from 0 to 1, no
/// altered mesh for collision. The message begins with "meshes".
std::optional<Error> check_link_meshes(const std::vector<LinkMesh>& meshes);

/// A mesh's content, compressed for messages, files and stores.
struct MeshContent {
  std::uint32_t bytes = 0;         ///< before compression: 8 + 12 a vertex + 12 a triangle
  std::vector<std::uint8_t> zlib;  ///< the canonical bytes as one zlib stream
};

/// Vertices and triangles in the one order that equal meshes have.
///
/// Invariant: finite vertices, each once, in lexicographic order, each used; triangles in
/// lexicographic order, each once, the smallest index first.
class TriangleMesh {
 public:
  TriangleMesh() = default;

  /// \param corners  3 x 3 n, m, three columns a triangle; rounded to 32 bits.
  /// \return InvalidInput for numbers that are not finite or beyond kMaxPlacement_m.
  static Result<TriangleMesh> from_corners(const Eigen::Matrix3Xd& corners);

  /// Decompresses a content. The declared size is checked before memory is allocated.
  /// \return TooLarge beyond kMaxCanonicalMeshBytes; InvalidInput for bytes that are not canonical.
  static Result<TriangleMesh> read(const MeshContent& content);

  MeshContent content() const;  ///< compressed
  Digest digest() const;        ///< SHA-256 of the canonical bytes, before compression
  std::size_t bytes() const;
  /// Counts, vertices, triangles: see MeshContent in proto/idl/register.idl.
  std::vector<std::uint8_t> canonical() const;
  /// The corners as from_corners() takes them.
  Eigen::Matrix3Xd corners() const;

  const std::vector<float>& vertices() const noexcept { return vertices_; }  ///< x y z, m
  const std::vector<std::uint32_t>& triangles() const noexcept { return triangles_; }

 private:
  std::vector<float> vertices_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace kinship
