#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
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

/// Adds contents that a registered robot names and that are not there, up to a size of all.
MeshesPut insert_meshes(Session& session, const Digest& robot,
                        const std::vector<MeshContent>& contents, const MeshLimits& limits);

/// Drops the contents that no registered robot names; none while a robot's row is damaged.
void drop_unnamed_meshes(Session& session);

/// Whether the payload of a row is as it was written.
bool is_mesh_sound(Session& session, std::int64_t row);
void drop_mesh(Session& session, std::int64_t row);

}  // namespace kinship::store
