#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "server/store/store.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store {

/// The waypoints of a dropped path, with encoding 2.
inline constexpr std::array<std::uint8_t, 1> kNoWaypoints = {0};
inline constexpr std::int64_t kEncodingOfDropped = 2;

/// The values that a path's checksum covers: all that a transfer relies on, not the waypoints
/// alone.
struct PathContent {
  Bytes report_uuid;
  Bytes T_task_base;  ///< as stored; empty: missing
  std::int64_t dof = 0;
  std::int64_t waypoint_count = 0;
  std::int64_t encoding = 0;
  Bytes waypoints;

  /// Encodings never make so short a blob.
  bool is_dropped() const { return waypoints.size() == 1; }
  std::uint32_t crc() const;

  /// The path without its id, its scene and the time it was received.
  /// \return nothing if the waypoints or the placement cannot be decoded.
  std::optional<StoredPath> decode() const;
};

/// The numbers of the columns below.
struct PathColumn {
  static constexpr int kId = 0, kReportUuid = 1, kPlacement = 2, kDof = 3, kWaypointCount = 4,
                       kEncoding = 5, kCrc = 6, kWaypoints = 7, kReceivedMs = 8, kSceneId = 9;
};

/// The columns that the checksum covers, and the checksum.
inline constexpr std::string_view kPathContentColumns =
    "path.id, path.report_uuid, path.T_task_base, path.dof, path.waypoint_count, path.encoding, "
    "path.crc32c, path.waypoints ";
inline constexpr std::string_view kPathColumns =
    "path.id, path.report_uuid, path.T_task_base, path.dof, path.waypoint_count, path.encoding, "
    "path.crc32c, path.waypoints,"
    " path.received_ms, path.scene_id ";

/// \param row  of kPathContentColumns, or of kPathColumns.
template <Columns Row>
PathContent path_content_of(const Row& row) {
  return {row.column_blob(PathColumn::kReportUuid),  row.column_blob(PathColumn::kPlacement),
          row.column_integer(PathColumn::kDof),      row.column_integer(PathColumn::kWaypointCount),
          row.column_integer(PathColumn::kEncoding), row.column_blob(PathColumn::kWaypoints)};
}

/// \param row  of kPathContentColumns, or of kPathColumns.
template <Columns Row>
bool has_right_path_crc(const Row& row) {
  return path_content_of(row).crc() == row.column_integer(PathColumn::kCrc);
}

/// Nothing if it is damaged.
/// \param row  of kPathContentColumns.
template <Columns Row>
std::optional<StoredPath> read_path_content(const Row& row) {
  if (!has_right_path_crc(row))
    return std::nullopt;
  std::optional<StoredPath> path = path_content_of(row).decode();
  if (path)
    path->id = row.column_integer(PathColumn::kId);
  return path;
}

/// The same with all columns.
/// \param row  of kPathColumns.
template <Columns Row>
std::optional<StoredPath> read_path(const Row& row) {
  std::optional<StoredPath> path = read_path_content(row);
  if (!path)
    return std::nullopt;
  path->received_ms = row.column_integer(PathColumn::kReceivedMs);
  path->scene_id = optional_integer_of(row, PathColumn::kSceneId);
  return path;
}

}  // namespace kinship::store
