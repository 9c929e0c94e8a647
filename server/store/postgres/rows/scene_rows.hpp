#pragma once

#include <cstdint>
#include <optional>

#include "proto/types/recorded_scene.hpp"
#include "server/store/postgres/database/connection.hpp"

namespace kinship::store::postgres {

/// A scene as read: nothing if it is damaged, was set aside before, or is not there.
struct SceneRead {
  std::optional<RecordedScene> scene;
  bool damaged = false;  ///< found now
};
SceneRead select_scene(Connection& connection, std::int64_t id);

/// Until a report brings it anew, under its id. In a writing transaction.
void set_aside_scene(Connection& connection, std::int64_t id);

}  // namespace kinship::store::postgres
