#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "proto/types/recorded_scene.hpp"
#include "server/store/values/bytes.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store {

/// Encoding of a scene in the database; the numbers are part of the schema.
enum class SceneEncoding : std::uint8_t { Plain = 1, Zstd = 2 };

/// A scene as a blob, with the values needed to decode it.
struct SceneBlob {
  std::int64_t size = 0;  ///< before compression
  SceneEncoding encoding = SceneEncoding::Plain;
  std::vector<std::uint8_t> bytes;
};

/// \param scene  keeps the rules of check_scene().
/// \return the smaller of the two encodings; both keep every number, poses as 7 numbers.
SceneBlob encode_scene(const RecordedScene& scene);

/// \return empty if the blob is no result of encode_scene, or breaks a rule of check_scene().
std::optional<RecordedScene> decode_scene(std::int64_t size, std::int64_t encoding,
                                          std::span<const std::uint8_t> bytes);

/// The checksum of a scene's row. It covers the content's digest: a scene under another's digest
/// would be taken for that one.
std::uint32_t scene_crc(Bytes content, std::int64_t size, std::int64_t encoding, Bytes scene);

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
