#include "server/store/postgres/rows/scene_rows.hpp"

#include <string>

#include "server/store/values/clock.hpp"
#include "server/store/values/scene_columns.hpp"

namespace kinship::store::postgres {

SceneRead select_scene(Connection& connection, std::int64_t id) {
  const Rows rows = connection.query(
      "SELECT " + std::string(kSceneColumns) + "FROM scene WHERE id = $1 AND damaged_ms IS NULL",
      id);
  SceneRead read;
  if (rows.empty())
    return read;
  read.scene = read_scene_columns(rows.front());
  read.damaged = !read.scene;
  return read;
}

void set_aside_scene(Connection& connection, std::int64_t id) {
  connection.query("UPDATE scene SET damaged_ms = $2 WHERE id = $1 AND damaged_ms IS NULL", id,
                   now_ms());
}

}  // namespace kinship::store::postgres
