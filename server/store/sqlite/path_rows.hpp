#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "server/store/sqlite/database.hpp"
#include "server/store/sqlite/prepared_attempt.hpp"
#include "server/store/sqlite/writer.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// The internal ids of a robot and a task.
struct ExperienceKey {
  std::int64_t task_id = 0;
  std::int64_t robot_id = 0;
};

/// The undamaged path of this content, if it is there.
std::optional<std::int64_t> find_path(Database& database, const ExperienceKey& key,
                                      const Digest& content);

/// \return the id of the new path.
std::int64_t insert_path(Database& database, const ExperienceKey& key,
                         const PreparedAttempt& prepared);

/// Paths as read, and the ids of those whose checksum or content is wrong.
struct PathsRead {
  std::vector<StoredPath> paths;
  std::vector<std::int64_t> damaged;
};

/// The paths of a robot and task with id > after_id, in the order of ids, at most `limit`; damaged
/// ones do not count towards it.
PathsRead select_paths(Database& database, const ExperienceKey& key, std::int64_t after_id,
                       std::int64_t limit);

/// The path with this id: none if it was set aside before.
PathsRead select_path(Database& database, std::int64_t id);

/// Sets paths aside: out of the counts and of every reading, and the generation is raised. One that
/// is aside already stays so.
void set_aside(Batch& batch, const std::vector<std::int64_t>& paths);

/// Those of the newest `count` paths of all that are damaged and not set aside yet.
std::vector<std::int64_t> find_damaged_paths(Database& database, std::int64_t count);

}  // namespace kinship::store
