#pragma once

#include <optional>
#include <string_view>

#include "server/store/values/columns.hpp"
#include "server/store/values/scene_blob.hpp"

/// How a scene stands in its row.
namespace kinship::store {

inline constexpr std::string_view kSceneColumns =
    "id, content_sha256, size, encoding, crc32c, scene ";

/// \param row  of kSceneColumns.
template <Columns Row>
bool has_right_scene_crc(const Row& row) {
  return scene_crc(row.column_blob(1), row.column_integer(2), row.column_integer(3),
                   row.column_blob(5)) == row.column_integer(4);
}

/// Nothing if it is damaged.
/// \param row  of kSceneColumns.
template <Columns Row>
std::optional<RecordedScene> read_scene_columns(const Row& row) {
  if (!has_right_scene_crc(row))
    return std::nullopt;
  return decode_scene(row.column_integer(2), row.column_integer(3), row.column_blob(5));
}

}  // namespace kinship::store
