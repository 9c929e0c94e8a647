#include "server/store/sqlite/rows/retention.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store {
namespace {

constexpr std::uint64_t kMostDroppedAtOnce = 64;  // each is written anew

std::uint64_t paths_of(Database& database, const ExperienceKey& key) {
  const auto query =
      database.cached("SELECT paths FROM experience WHERE task_id = ? AND robot_id = ?");
  return query->bind_all(key.task_id, key.robot_id).step() ? count_of(*query, 0) : 0;
}

struct KeptPath {
  std::int64_t id = 0;
  Digest content;
};

/// Those in use by descending content, from an index.
std::vector<KeptPath> last_kept(Database& database, const ExperienceKey& key, std::uint64_t skipped,
                                std::uint64_t count) {
  const auto query = database.cached(
      "SELECT id, content_sha256 FROM path INDEXED BY path_by_content "
      "WHERE robot_id = ? AND task_id = ? AND retired_ms IS NULL AND NOT EXISTS "
      "(SELECT 1 FROM set_aside WHERE kind = 1 AND set_aside.id = path.id) "
      "ORDER BY content_sha256 DESC LIMIT ? OFFSET ?");
  query->bind_all(key.robot_id, key.task_id, static_cast<std::int64_t>(count),
                  static_cast<std::int64_t>(skipped));
  std::vector<KeptPath> paths;
  while (query->step())
    paths.push_back({query->column_integer(0), id_of<Digest>(query->column_blob(1))});
  return paths;
}

}  // namespace

bool is_within_cap(Database& database, const ExperienceKey& key, const Digest& content,
                   std::uint64_t max_paths) {
  if (max_paths == 0)
    return true;
  const std::uint64_t paths = paths_of(database, key);
  if (paths < max_paths)
    return true;
  // The threshold lies behind all that is to be dropped first. While that is much (the cap was
  // lowered) this one is taken too: it is dropped in its turn, and the same ones stay in the end.
  if (paths - max_paths > kMostDroppedAtOnce)
    return true;
  const std::vector<KeptPath> largest = last_kept(database, key, paths - max_paths, 1);
  // Equal: it stands for a path that cannot be read any more.
  return largest.empty() || content <= largest.front().content;
}

void drop_excess(Batch& batch, const ExperienceKey& key, std::uint64_t max_paths) {
  if (max_paths == 0)
    return;
  Database& database = batch.database();
  const std::uint64_t paths = paths_of(database, key);
  if (paths <= max_paths)
    return;
  for (const KeptPath& path :
       last_kept(database, key, 0, std::min(paths - max_paths, kMostDroppedAtOnce)))
    drop_path(batch, key, path.id);
}

}  // namespace kinship::store
