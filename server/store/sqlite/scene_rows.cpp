#include "server/store/sqlite/scene_rows.hpp"

#include "server/store/crc32c.hpp"
#include "server/store/sqlite/byte_stream.hpp"
#include "server/store/sqlite/row_values.hpp"

namespace kinship::store {
namespace {

constexpr std::string_view kSceneColumns =
    "SELECT id, content_sha256, size, encoding, crc32c, scene FROM scene ";

/// The content's digest is under the checksum: a scene that stands under another's digest would be
/// taken for it.
std::uint32_t crc_of(Bytes content, std::int64_t size, std::int64_t encoding, Bytes scene) {
  ByteWriter header;
  header.add(content);
  for (const std::int64_t number : {size, encoding})
    header.add(static_cast<std::uint64_t>(number));
  return crc32c(scene, crc32c(header.bytes()));
}

/// \param row  of kSceneColumns.
std::optional<RecordedScene> read_scene(const Statement& row) {
  const Bytes content = row.column_blob(1), scene = row.column_blob(5);
  const std::int64_t size = row.column_integer(2), encoding = row.column_integer(3);
  if (crc_of(content, size, encoding, scene) != row.column_integer(4))
    return std::nullopt;
  return decode_scene(size, encoding, scene);
}

}  // namespace

std::int64_t ensure_scene(Database& database, const PreparedScene& scene,
                          std::int64_t received_ms) {
  const Bytes content(scene.content.bytes);
  std::optional<std::int64_t> damaged;
  {
    const auto query = database.cached("SELECT id, damaged FROM scene WHERE content_sha256 = ?");
    if (query->bind(1, content).step()) {
      if (query->column_integer(1) == 0)
        return query->column_integer(0);
      damaged = query->column_integer(0);
    }
  }
  const auto encoding = static_cast<std::int64_t>(scene.blob.encoding);
  const Bytes bytes(scene.blob.bytes);
  const std::int64_t crc = crc_of(content, scene.blob.size, encoding, bytes);
  if (damaged) {
    database
        .cached(
            "UPDATE scene SET damaged = 0, received_ms = ?, size = ?, encoding = ?, crc32c = ?,"
            " scene = ? WHERE id = ?")
        ->bind_all(received_ms, scene.blob.size, encoding, crc, bytes, *damaged)
        .run();
    return *damaged;
  }
  database
      .cached(
          "INSERT INTO scene (content_sha256, received_ms, size, encoding, crc32c, scene) "
          "VALUES (?, ?, ?, ?, ?, ?)")
      ->bind_all(content, received_ms, scene.blob.size, encoding, crc, bytes)
      .run();
  return database.last_insert_id();
}

SceneRead select_scene(Database& database, std::int64_t id) {
  const auto query = database.cached(std::string(kSceneColumns) + "WHERE id = ? AND damaged = 0");
  SceneRead read;
  if (query->bind(1, id).step()) {
    read.scene = read_scene(*query);
    read.damaged = !read.scene;
  }
  return read;
}

void set_scene_aside(Database& database, std::int64_t id) {
  database.cached("UPDATE scene SET damaged = 1 WHERE id = ?")->bind(1, id).run();
}

ScenesChecked check_scenes(Database& database, std::int64_t after_id, std::int64_t limit) {
  const auto query = database.cached(std::string(kSceneColumns) +
                                     "WHERE id > ? AND damaged = 0 ORDER BY id LIMIT ?");
  query->bind_all(after_id, limit);
  ScenesChecked checked;
  while (query->step()) {
    checked.last_id = query->column_integer(0);
    ++checked.scenes;
    if (!read_scene(*query))
      checked.damaged.push_back(checked.last_id);
  }
  return checked;
}

}  // namespace kinship::store
