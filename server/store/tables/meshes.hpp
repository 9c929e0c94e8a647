#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/link_mesh.hpp"
#include "server/store/session.hpp"
#include "server/store/store.hpp"

/// The contents of robots' meshes, by digest.
namespace kinship::store {

/// Compressed bytes of those of the contents that are there, and sound.
std::map<Digest, std::uint64_t> select_known_meshes(Session& session,
                                                    const std::set<Digest>& contents);

/// Nothing also if it is damaged.
std::optional<MeshContent> select_mesh(Session& session, const Digest& content);

MeshUse count_meshes(Session& session);

/// A content that is a mesh. Borrowed.
struct ReadMesh {
  Digest digest;
  const MeshContent* content = nullptr;
};

/// Contents as a client sent them. It takes as long as to decompress them: not for a transaction.
struct ReadMeshes {
  explicit ReadMeshes(const std::vector<MeshContent>& contents);
  explicit ReadMeshes(std::vector<MeshContent>&&) = delete;  // would not outlive it

  std::vector<ReadMesh> meshes;
  std::size_t refused = 0;  ///< that are none
  std::string why;          ///< the last of these
};

/// Adds contents that a registered robot names and that are not there, up to a size of all.
MeshesPut insert_meshes(Session& session, const Digest& robot, const ReadMeshes& contents,
                        const MeshLimits& limits);

/// Drops the contents that no registered robot names; none while a robot's row is damaged.
void drop_unnamed_meshes(Session& session);

/// Whether the payload of a row is as it was written.
bool is_mesh_sound(Session& session, std::int64_t row);
void drop_mesh(Session& session, std::int64_t row);

}  // namespace kinship::store
