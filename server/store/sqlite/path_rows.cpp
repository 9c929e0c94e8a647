#include "server/store/sqlite/path_rows.hpp"

#include <string>
#include <utility>

#include "server/store/crc32c.hpp"
#include "server/store/sqlite/row_values.hpp"

namespace kinship::store {
namespace {

/// Where a column stands among the selected ones. Schema 1 has no more than its content.
struct PathColumn {
  static constexpr int kId = 0, kReportUuid = 1, kPlacement = 2, kDof = 3, kWaypointCount = 4,
                       kEncoding = 5, kCrc = 6, kWaypoints = 7, kReceivedMs = 8, kSceneId = 9;
};

constexpr std::string_view kPathContentColumns =
    "SELECT id, report_uuid, T_task_base, dof, waypoint_count, encoding, crc32c, waypoints ";
constexpr std::string_view kPathColumns =
    "SELECT id, report_uuid, T_task_base, dof, waypoint_count, encoding, crc32c, waypoints,"
    " received_ms, scene_id FROM path ";

/// Everything that a transfer relies on is under the checksum, not the waypoints alone.
struct PathContent {
  Bytes report_uuid;
  Bytes T_task_base;  // empty: missing
  std::int64_t dof = 0;
  std::int64_t waypoint_count = 0;
  std::int64_t encoding = 0;
  Bytes waypoints;

  std::uint32_t crc() const {
    ByteWriter header;
    header.add(report_uuid).add(T_task_base);
    for (const std::int64_t number : {dof, waypoint_count, encoding})
      header.add(static_cast<std::uint64_t>(number));
    return crc32c(waypoints, crc32c(header.bytes()));
  }
};

/// A path without the time it was received and its scene, or nothing if it is damaged.
/// \param row  of kPathContentColumns, or of kPathColumns.
std::optional<StoredPath> read_path_content(const Statement& row) {
  const PathContent content{
      row.column_blob(PathColumn::kReportUuid),  row.column_blob(PathColumn::kPlacement),
      row.column_integer(PathColumn::kDof),      row.column_integer(PathColumn::kWaypointCount),
      row.column_integer(PathColumn::kEncoding), row.column_blob(PathColumn::kWaypoints)};
  if (content.crc() != row.column_integer(PathColumn::kCrc))
    return std::nullopt;
  std::optional<Path> path =
      decode_waypoints(content.dof, content.waypoint_count, content.encoding, content.waypoints);
  if (!path)
    return std::nullopt;
  std::optional<Eigen::Isometry3d> T_task_base;
  if (!row.column_is_null(PathColumn::kPlacement)) {
    T_task_base = pose_from_blob(content.T_task_base);
    if (!T_task_base)
      return std::nullopt;
  }
  return StoredPath{row.column_integer(PathColumn::kId), id_of<Uuid>(content.report_uuid),
                    T_task_base, 0, std::move(*path)};
}

/// \param row  of kPathColumns.
void take_row(const Statement& row, PathsRead& read) {
  std::optional<StoredPath> path = read_path_content(row);
  if (!path) {
    read.damaged.push_back(row.column_integer(PathColumn::kId));
    return;
  }
  path->received_ms = row.column_integer(PathColumn::kReceivedMs);
  if (!row.column_is_null(PathColumn::kSceneId))
    path->scene_id = row.column_integer(PathColumn::kSceneId);
  read.paths.push_back(std::move(*path));
}

/// \return its robot and task, or nothing if it was in no fit any more.
std::optional<ExperienceKey> mark_damaged(Database& database, std::int64_t id) {
  ExperienceKey key;
  bool in_use = false;
  {
    const auto query = database.cached(
        "SELECT task_id, robot_id, retired_ms IS NULL FROM path WHERE id = ? AND damaged = 0");
    if (!query->bind(1, id).step())
      return std::nullopt;
    key = {query->column_integer(0), query->column_integer(1)};
    in_use = query->column_integer(2) != 0;
  }
  database.cached("UPDATE path SET damaged = 1 WHERE id = ?")->bind(1, id).run();
  if (!in_use)
    return std::nullopt;
  uncount_paths(database, key, 1);
  return key;
}

}  // namespace

std::optional<std::int64_t> find_path(Database& database, const ExperienceKey& key,
                                      const Digest& content) {
  const auto query = database.cached(
      "SELECT id FROM path "
      "WHERE robot_id = ? AND task_id = ? AND content_sha256 = ? AND damaged = 0 "
      "AND retired_ms IS NULL");
  query->bind_all(key.robot_id, key.task_id, Bytes(content.bytes));
  if (!query->step())
    return std::nullopt;
  return query->column_integer(0);
}

std::int64_t insert_path(Database& database, const ExperienceKey& key,
                         const PreparedAttempt& prepared, const PathArrival& arrival) {
  const PreparedPath& path = *prepared.path;
  const auto T_task_base = optional_pose_blob(prepared.attempt.T_task_base);
  const PathContent content{Bytes(prepared.attempt.report_uuid.bytes),
                            blob_or_null(T_task_base).value_or(Bytes()),
                            path.blob.dof,
                            path.blob.waypoint_count,
                            static_cast<std::int64_t>(path.blob.encoding),
                            Bytes(path.blob.bytes)};
  database
      .cached(
          "INSERT INTO path (task_id, robot_id, report_uuid, content_sha256, length, T_task_base,"
          " dof, waypoint_count, encoding, crc32c, waypoints, received_ms, scene_id) "
          "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      ->bind_all(key.task_id, key.robot_id, content.report_uuid, Bytes(path.content.bytes),
                 path.length, blob_or_null(T_task_base), content.dof, content.waypoint_count,
                 content.encoding, std::int64_t{content.crc()}, content.waypoints,
                 arrival.received_ms, arrival.scene_id)
      .run();
  return database.last_insert_id();
}

PathsRead select_paths(Database& database, const ExperienceKey& key, const PathRange& range) {
  const auto query =
      database.cached(std::string(kPathColumns) +
                      "WHERE task_id = ? AND robot_id = ? AND id > ? AND received_ms >= ? "
                      "AND damaged = 0 AND retired_ms IS NULL ORDER BY id");
  query->bind_all(key.task_id, key.robot_id, range.after_id, range.since_ms);
  PathsRead read;
  while (read.paths.size() < range.limit && query->step())
    take_row(*query, read);
  return read;
}

PathsRead select_path(Database& database, std::int64_t id) {
  const auto query = database.cached(std::string(kPathColumns) + "WHERE id = ? AND damaged = 0");
  query->bind(1, id);
  PathsRead read;
  if (query->step())
    take_row(*query, read);
  return read;
}

void set_aside(Batch& batch, const std::vector<std::int64_t>& paths) {
  for (const std::int64_t path : paths)
    if (const auto key = mark_damaged(batch.database(), path))
      batch.paths_changed(key->task_id, key->robot_id);
}

PathsChecked check_paths(Database& database, std::int64_t after_id, std::int64_t limit) {
  const auto query = database.cached(std::string(kPathContentColumns) +
                                     "FROM path WHERE id > ? AND damaged = 0 ORDER BY id LIMIT ?");
  query->bind_all(after_id, limit);
  PathsChecked checked;
  while (query->step()) {
    checked.last_id = query->column_integer(PathColumn::kId);
    ++checked.paths;
    if (!read_path_content(*query))
      checked.damaged.push_back(checked.last_id);
  }
  return checked;
}

std::vector<std::int64_t> find_damaged_paths(Database& database, std::int64_t count) {
  const auto query =
      database.cached(std::string(kPathColumns) + "WHERE damaged = 0 ORDER BY id DESC LIMIT ?");
  query->bind(1, count);
  std::vector<std::int64_t> damaged;
  while (query->step())
    if (!read_path_content(*query))
      damaged.push_back(query->column_integer(PathColumn::kId));
  return damaged;
}

}  // namespace kinship::store
