#include "server/store/tables/contents.hpp"

#include <algorithm>
#include <string>

#include "server/store/tables/pages.hpp"
#include "server/store/values/scene_blob.hpp"

namespace kinship::store {
namespace {

/// Parameters $1 task, $2 robot.
std::string paths_in_use(Session& session) {
  return " WHERE task_id = " + id_of_task(session, "$1") +
         " AND robot_id = " + id_of_robot(session, "$2") + " AND retired_ms IS NULL AND NOT " +
         session.is_quarantined("path");
}

/// kPathColumns, and whether the row is as it was written.
std::string path_columns(Session& session) {
  return std::string(kPathColumns) + ", " + session.is_intact("path") + " ";
}

/// \param row  of path_columns().
void add_path(const Row& row, PathsRead& read) {
  constexpr int kIsIntact = PathColumn::kSceneId + 1;
  if (row.column_integer(kIsIntact) != 0)
    read.add(row);
  else
    read.damaged.push_back(row.column_integer(PathColumn::kId));
}

/// A part of the paths of a range.
struct PathsPart {
  PathsRead read;
  std::int64_t last_id = 0;
  bool is_last = false;
};

PathsPart select_part(Session& session, const Digest& robot, std::string_view task,
                      const PathRange& range) {
  PathsPart part;
  std::size_t rows = 0;
  for (const Row& row :
       session.query("SELECT " + path_columns(session) + "FROM path" + paths_in_use(session) +
                         " AND id > $3 AND received_ms >= $4 ORDER BY id LIMIT $5",
                     task, robot, range.after_id, range.since_ms, range.limit)) {
    add_path(row, part.read);
    part.last_id = row.column_integer(PathColumn::kId);
    ++rows;
  }
  part.is_last = rows < range.limit;
  return part;
}

template <typename Value>
void append(std::vector<Value>& all, std::vector<Value>& part) {
  std::ranges::move(part, std::back_inserter(all));
}

}  // namespace

PathsRead select_paths(Session& session, const Digest& robot, std::string_view task,
                       const PathRange& range) {
  constexpr std::size_t kPart = 500, kMaxPaths = 1'000'000;
  const std::size_t limit = std::min(range.limit, kMaxPaths);
  PathsRead read;
  PathRange next = range;
  while (read.paths.size() < limit) {
    next.limit = std::min(kPart, limit - read.paths.size());
    PathsPart part = select_part(session, robot, task, next);
    append(read.paths, part.read.paths);
    append(read.damaged, part.read.damaged);
    if (part.is_last)
      break;
    next.after_id = part.last_id;
  }
  return read;
}

std::vector<std::int64_t> select_path_ids(Session& session, const Digest& robot,
                                          std::string_view task) {
  std::vector<std::int64_t> ids;
  for (const Row& row :
       session.query("SELECT id FROM path" + std::string(session.dialect().by_task_robot) +
                         paths_in_use(session) + " ORDER BY id",
                     task, robot))
    ids.push_back(row.column_integer(0));
  return ids;
}

SceneRead select_scene(Session& session, std::int64_t id) {
  const auto read = session.unless_damaged([&]() -> std::optional<SceneRead> {
    const Rows rows =
        session.query("SELECT " + std::string(kSceneColumns) + ", " + session.is_intact("scene") +
                          " FROM scene WHERE id = $1 AND NOT " + session.is_quarantined("scene"),
                      id);
    if (rows.empty())
      return SceneRead();
    if (rows.front().column_integer(rows.front().columns() - 1) == 0)
      return SceneRead{std::nullopt, true};
    std::optional<RecordedScene> scene = read_scene_columns(rows.front());
    const bool is_damaged = !scene;
    return SceneRead{std::move(scene), is_damaged};
  });
  return read.value_or(SceneRead{std::nullopt, true});
}

}  // namespace kinship::store
