#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "server/store/session.hpp"
#include "server/store/store.hpp"
#include "server/store/values/path_content.hpp"

/// Readings of paths and scenes that verify their checksums.
namespace kinship::store {

/// Ids of damaged rows that a reading found and that are not quarantined yet.
struct DamagedRows {
  std::vector<std::int64_t> paths = {}, scenes = {}, attempts = {};
};

/// Paths as read, and the ids of paths with a wrong checksum or content.
struct PathsRead {
  std::vector<StoredPath> paths;
  std::vector<std::int64_t> damaged;

  /// Adds a path, unless it was dropped. \param row  of kPathColumns.
  template <Columns Row>
  void add(const Row& row) {
    if (path_content_of(row).is_dropped() && has_right_path_crc(row))
      return;
    if (std::optional<StoredPath> path = read_path(row))
      paths.push_back(std::move(*path));
    else
      damaged.push_back(row.column_integer(PathColumn::kId));
  }
};

/// The paths in use of a robot and task in order of ids; damaged ones do not count towards the
/// limit. Fetches some megabytes at a time. Call it in a
/// snapshot.
PathsRead select_paths(Session& session, const Digest& robot, std::string_view task,
                       const PathRange& range);

/// The ids of the paths in use, ascending, from an index.
std::vector<std::int64_t> select_path_ids(Session& session, const Digest& robot,
                                          std::string_view task);

/// A scene as read: nothing if it is damaged, was quarantined before, or is missing.
struct SceneRead {
  std::optional<RecordedScene> scene;
  bool damaged = false;  ///< found by this reading
};
SceneRead select_scene(Session& session, std::int64_t id);

/// Reports for another store, and the damaged rows found.
struct ReplicatedRead {
  ReplicatedReports found;
  DamagedRows damaged;
};

}  // namespace kinship::store
