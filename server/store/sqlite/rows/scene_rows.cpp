#include "server/store/sqlite/rows/scene_rows.hpp"

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/scene_blob.hpp"

namespace kinship::store {
namespace {

/// The ids of the rows of one content, from the index.
std::vector<std::int64_t> ids_of(Database& database, Bytes content) {
  const auto query =
      database.cached("SELECT id FROM scene INDEXED BY scene_by_content WHERE content_sha256 = ?");
  query->bind(1, content);
  std::vector<std::int64_t> ids;
  while (query->step())
    ids.push_back(query->column_integer(0));
  return ids;
}

}  // namespace

bool can_read_scene(Database& database, std::int64_t id) {
  try {
    const auto query =
        database.cached("SELECT " + std::string(kSceneColumns) + "FROM scene WHERE id = ? AND " +
                        database.is_intact("scene"));
    return query->bind(1, id).step() && has_right_scene_crc(*query);
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    return false;
  }
}

SceneRows find_scene(Database& database, const Digest& content) {
  SceneRows rows;
  for (const std::int64_t id : ids_of(database, Bytes(content.bytes))) {
    const std::optional<QuarantinedRow> quarantined = find_quarantined(database, "scene", id);
    if (!quarantined && can_read_scene(database, id))
      rows.readable = id;
    else if (!quarantined || !quarantined->replaced_by)
      rows.damaged.push_back(id);
  }
  return rows;
}

std::int64_t insert_scene(Database& database, const PreparedScene& scene, std::int64_t received_ms,
                          const std::vector<std::int64_t>& damaged) {
  const Bytes content(scene.content.bytes);
  const auto encoding = static_cast<std::int64_t>(scene.blob.encoding);
  const Bytes bytes(scene.blob.bytes);
  const std::int64_t crc = scene_crc(content, scene.blob.size, encoding, bytes);
  database
      .cached(
          "INSERT INTO scene (content_sha256, received_ms, size, encoding, crc32c, scene) "
          "VALUES (?, ?, ?, ?, ?, ?)")
      ->bind_all(content, received_ms, scene.blob.size, encoding, crc, bytes)
      .run();
  const std::int64_t id = database.inserted_id();
  for (const std::int64_t old : damaged)
    quarantine_row(database, "scene", old, id);
  return id;
}

SceneRead select_current_scene(Database& database, std::int64_t id) {
  const std::optional<std::int64_t> row = row_in_use(database, "scene", id);
  return row ? select_scene(database, *row) : SceneRead();
}

bool is_scene_readable(Database& database, std::int64_t id) {
  const std::optional<std::int64_t> row = row_in_use(database, "scene", id);
  return row && can_read_scene(database, *row);
}

}  // namespace kinship::store
