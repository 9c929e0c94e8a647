#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "server/store/sqlite/database.hpp"
#include "server/store/sqlite/experience_rows.hpp"
#include "server/store/sqlite/prepared_attempt.hpp"
#include "server/store/sqlite/writer.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// The path in use (neither damaged nor retired) of this content, if it is there.
std::optional<std::int64_t> find_path(Database& database, const ExperienceKey& key,
                                      const Digest& content);

/// What a path is written with beside what its attempt says.
struct PathArrival {
  std::int64_t received_ms = 0;
  std::optional<std::int64_t> scene_id;
};

/// \return the id of the new path.
std::int64_t insert_path(Database& database, const ExperienceKey& key,
                         const PreparedAttempt& prepared, const PathArrival& arrival);

/// Paths as read, and the ids of those whose checksum or content is wrong.
struct PathsRead {
  std::vector<StoredPath> paths;
  std::vector<std::int64_t> damaged;
};

/// The paths in use of a robot and task in the order of ids; damaged ones do not count towards the
/// limit.
PathsRead select_paths(Database& database, const ExperienceKey& key, const PathRange& range);

/// The path with this id, also a retired one: none if it was set aside before.
PathsRead select_path(Database& database, std::int64_t id);

/// Sets paths aside: out of the counts and of every reading, and the generation is raised. One that
/// is aside already stays so; one that is retired was out of the counts before.
void set_aside(Batch& batch, const std::vector<std::int64_t>& paths);

/// A part of a full check.
struct PathsChecked {
  std::int64_t last_id = 0;
  std::uint64_t paths = 0;
  std::vector<std::int64_t> damaged;
};

/// Decodes the next paths with id > after_id, at most `limit`, retired ones too; those set aside
/// are left out.
PathsChecked check_paths(Database& database, std::int64_t after_id, std::int64_t limit);

/// Those of the newest `count` paths of all that are damaged and not set aside yet.
std::vector<std::int64_t> find_damaged_paths(Database& database, std::int64_t count);

}  // namespace kinship::store
