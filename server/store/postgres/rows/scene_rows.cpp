#include "server/store/postgres/rows/scene_rows.hpp"

#include "server/store/values/clock.hpp"
#include "server/store/values/scene_blob.hpp"

namespace kinship::store::postgres {

SceneRead select_scene(Connection& connection, std::int64_t id) {
  const Rows rows = connection.query(
      "SELECT content_sha256, size, encoding, crc32c, scene FROM scene"
      " WHERE id = $1 AND damaged_ms IS NULL",
      id);
  SceneRead read;
  if (rows.empty())
    return read;
  const Row row = rows.front();
  const std::int64_t size = row.column_integer(1), encoding = row.column_integer(2);
  if (scene_crc(row.column_blob(0), size, encoding, row.column_blob(4)) == row.column_integer(3))
    read.scene = decode_scene(size, encoding, row.column_blob(4));
  read.damaged = !read.scene;
  return read;
}

void set_aside_scene(Connection& connection, std::int64_t id) {
  connection.query("UPDATE scene SET damaged_ms = $2 WHERE id = $1 AND damaged_ms IS NULL", id,
                   now_ms());
}

}  // namespace kinship::store::postgres
