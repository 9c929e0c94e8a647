#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/tables/contents.hpp"
#include "server/store/values/prepared_attempt.hpp"

/// Scenes, one row for each content.
namespace kinship::store {

/// The rows of one content.
struct SceneRows {
  std::optional<std::int64_t> readable;
  std::vector<std::int64_t> damaged;  ///< not replaced yet
};
SceneRows find_scene(Database& database, const Digest& content);

/// Inserts a scene, which replaces the damaged rows of its content. \return its id.
std::int64_t insert_scene(Database& database, const PreparedScene& scene, std::int64_t received_ms,
                          const std::vector<std::int64_t>& damaged);

/// The scene with this id, or its replacement.
SceneRead select_current_scene(Database& database, std::int64_t id);

/// Whether a scene, or its replacement, can be read.
bool is_scene_readable(Database& database, std::int64_t id);

/// Whether the row with this id is as it was written.
bool can_read_scene(Database& database, std::int64_t id);

}  // namespace kinship::store
