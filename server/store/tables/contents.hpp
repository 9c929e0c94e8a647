#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "server/store/session.hpp"
#include "server/store/store.hpp"
#include "server/store/values/path_content.hpp"

/// Paths and scenes, as read with their checksums.
namespace kinship::store {

/// Ids of rows that turned out damaged while others were read, and are not quarantined yet.
struct DamagedRows {
  std::vector<std::int64_t> paths = {}, scenes = {}, attempts = {};
};

/// Paths as read, and the ids of those whose checksum or content is wrong.
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

/// The paths in use of a robot and task in the order of ids; damaged ones do not count towards the
/// limit. Some megabytes at a time are fetched. In a snapshot.
PathsRead select_paths(Session& session, const Digest& robot, std::string_view task,
                       const PathRange& range);

/// The ids of the paths in use, ascending, from an index.
std::vector<std::int64_t> select_path_ids(Session& session, const Digest& robot,
                                          std::string_view task);

/// A scene as read: nothing if it is damaged, was quarantined before, or is not there.
struct SceneRead {
  std::optional<RecordedScene> scene;
  bool damaged = false;  ///< found now
};
SceneRead select_scene(Session& session, std::int64_t id);

/// Reports as read for another store.
struct SharedRead {
  SharedReports found;
  DamagedRows damaged;
};

}  // namespace kinship::store
