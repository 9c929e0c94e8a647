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

/// Finds the paths with this content, and reads them to verify their checksums.
SameContent find_same(Database& database, const ExperienceKey& key, const Digest& content);

/// Whether a path or its replacement can be read, or need not be, because it is retired.
bool is_receipt_backed(Database& database, const ExperienceKey& key, std::int64_t id);

/// The paths in use with the largest digests, at most `limit`. From an index.
std::set<KeptPath> select_largest(Database& database, const ExperienceKey& key,
                                  std::uint64_t limit);

/// Inserts a path under a new id. \return the id.
std::int64_t insert_path(Database& database, const NewPath& path,
                         std::optional<std::int64_t> scene_id, std::int64_t now_ms);

/// The path with this id or its replacement, also a retired one: none if it is quarantined or
/// dropped.
PathsRead select_path(Database& database, std::int64_t id);

/// Whether a path is retired. From an index: its row need not be readable.
bool is_retired(Database& database, const ExperienceKey& key, std::int64_t id);

/// The retired path of a report, searched among all of its robot and task.
std::optional<std::int64_t> find_retired(Database& database, const ExperienceKey& key,
                                         const Uuid& report_uuid);

/// Quarantines paths: takes them out of the counts and of every reading, and raises the generation.
/// A quarantined path stays so; a retired one was out of the counts before. Their rows are not
/// touched.
void quarantine_paths(Batch& batch, const std::vector<std::int64_t>& paths);
/// Quarantines a path as retired, because its row could not be written.
void retire_damaged(Batch& batch, const ExperienceKey& key, std::int64_t id);

/// Quarantines a path as rules/batch_changes says, which also has the counts; if it is not
/// replaced, as retired.
void write_damaged(Database& database, const ExperienceKey& key, const DamagedPath& path);

/// Drops a path: its row stays, retired, without its waypoints. If the row cannot be written, the
/// path is quarantined as retired. The counts are in rules/batch_changes.
void drop_path(Database& database, const ExperienceKey& key, std::int64_t id);

/// Whether a path's row is as it was written and its waypoints, if it has any, can be decoded.
bool is_path_decodable(Database& database, std::int64_t id);

/// The damaged ones, not quarantined yet, of the newest `count` paths of the store.
std::vector<std::int64_t> find_damaged_paths(Database& database, std::int64_t count);

}  // namespace kinship::store
