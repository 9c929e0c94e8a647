#include "server/store/tables/contents.hpp"

#include <algorithm>
#include <string>

#include "server/store/values/scene_blob.hpp"

namespace kinship::store {
namespace {

/// Parameters $1 task, $2 robot.
std::string paths_in_use(const Session& session) {
  return " WHERE task_id = (SELECT id FROM task WHERE name = $1)"
         " AND robot_id = (SELECT id FROM robot WHERE digest = $2) AND retired_ms IS NULL AND "
         "NOT " +
         std::string(session.dialect().is_quarantined_path);
}

/// A part of the paths of a range.
struct PathsPart {
  PathsRead read;
  std::int64_t last_id = 0;
  bool is_last = false;
};

/// \return nothing if it met a damaged page.
std::optional<PathsPart> select_part(Session& session, const Digest& robot, std::string_view task,
                                     const PathRange& range) {
  return session.unless_damaged([&]() -> std::optional<PathsPart> {
    PathsPart part;
    std::size_t rows = 0;
    for (const Row& row :
         session.query("SELECT " + std::string(kPathColumns) + "FROM path" + paths_in_use(session) +
                           " AND id > $3 AND received_ms >= $4 ORDER BY id LIMIT $5",
                       task, robot, range.after_id, range.since_ms, range.limit)) {
      part.read.add(row);
      part.last_id = row.column_integer(PathColumn::kId);
      ++rows;
    }
    part.is_last = rows < range.limit;
    return part;
  });
}

/// The same one by one, by the ids of an index.
PathsPart select_readable(Session& session, const Digest& robot, std::string_view task,
                          const PathRange& range) {
  PathsPart part{.read = {}, .last_id = range.after_id, .is_last = true};
  for (const Row& id : session.query(
           "SELECT id FROM path" + std::string(session.dialect().by_task_robot) +
               paths_in_use(session) + " AND id > $3 AND received_ms >= $4 ORDER BY id LIMIT $5",
           task, robot, range.after_id, range.since_ms, range.limit)) {
    part.last_id = id.column_integer(0);
    part.is_last = false;
    if (!session.unless_damaged([&] {
          for (const Row& row : session.query(
                   "SELECT " + std::string(kPathColumns) + "FROM path WHERE id = $1", part.last_id))
            part.read.add(row);
          return true;
        }))
      part.read.damaged.push_back(part.last_id);
  }
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
    std::optional<PathsPart> part = select_part(session, robot, task, next);
    if (!part)
      part = select_readable(session, robot, task, next);
    append(read.paths, part->read.paths);
    append(read.damaged, part->read.damaged);
    if (part->is_last)
      break;
    next.after_id = part->last_id;
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
        session.query("SELECT " + std::string(kSceneColumns) + "FROM scene WHERE id = $1 AND NOT " +
                          std::string(session.dialect().is_quarantined_scene),
                      id);
    if (rows.empty())
      return SceneRead();
    std::optional<RecordedScene> scene = read_scene_columns(rows.front());
    const bool is_damaged = !scene;
    return SceneRead{std::move(scene), is_damaged};
  });
  return read.value_or(SceneRead{std::nullopt, true});
}

}  // namespace kinship::store
