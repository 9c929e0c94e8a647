#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "server/store/rules/batch_changes.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/contents.hpp"
#include "server/store/values/prepared_attempt.hpp"

namespace kinship::store {

/// Reads what it finds, and looks at its checksum.
SameContent find_same(Database& database, const ExperienceKey& key, const Digest& content);

/// Whether a path, or what replaced it, can be read, or was retired, so that nobody wants it.
bool is_vouched_for(Database& database, const ExperienceKey& key, std::int64_t id);

/// From an index: the paths in use of the largest digests, at most `limit`.
std::set<KeptPath> select_largest(Database& database, const ExperienceKey& key,
                                  std::uint64_t limit);

/// Under an id of its own. \return that.
std::int64_t insert_path(Database& database, const NewPath& path,
                         std::optional<std::int64_t> scene_id, std::int64_t now_ms);

/// The path with this id, or what replaced it, also a retired one: none if it is set aside, or
/// dropped.
PathsRead select_path(Database& database, std::int64_t id);

/// From an index: whether a path is retired, its row need not be readable.
bool is_retired(Database& database, const ExperienceKey& key, std::int64_t id);

/// The retired path that a report brought, looked for among all of its robot and task.
std::optional<std::int64_t> find_retired(Database& database, const ExperienceKey& key,
                                         const Uuid& report_uuid);

/// Sets paths aside: out of the counts and of every reading, and the generation is raised. One that
/// is aside already stays so; one that is retired was out of the counts before. Their rows are not
/// touched, they may lie on a damaged page.
void set_aside(Batch& batch, const std::vector<std::int64_t>& paths);
/// Sets one aside as retired: it could not be written.
void retire_damaged(Batch& batch, const ExperienceKey& key, std::int64_t id);

/// Sets one aside as rules/batch_changes says, which has the counts too; not replaced: as retired.
void write_damaged(Database& database, const ExperienceKey& key, const DamagedPath& path);

/// Takes a path out of use for good: its row stays, retired, its waypoints do not. One that cannot
/// be written is set aside as retired. The counts are in rules/batch_changes.
void drop_path(Database& database, const ExperienceKey& key, std::int64_t id);

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
