#include "server/store/sqlite/rows/path_rows.hpp"

#include <string>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/path_content.hpp"

namespace kinship::store {
namespace {

/// Runs a function that reads one row. \return false if the row cannot be read.
template <typename Read>
bool can_read(Read read) {
  try {
    return read();
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    return false;
  }
}

/// \return whether the path is there and its checksum is right.
bool is_readable(Database& database, std::int64_t id) {
  return can_read([&] {
    const auto query = database.cached("SELECT " + std::string(kPathContentColumns) +
                                       "FROM path WHERE id = ? AND " + database.is_intact("path"));
    return query->bind(1, id).step() && has_right_path_crc(*query);
  });
}

/// Not by the index that led to it.
bool has_content(Database& database, std::int64_t id, const ExperienceKey& key,
                 const Digest& content) {
  const auto query = database.cached(
      "SELECT 1 FROM path NOT INDEXED"
      " WHERE id = ? AND task_id = ? AND robot_id = ? AND content_sha256 = ?");
  return query->bind_all(id, key.task_id, key.robot_id, Bytes(content.bytes)).step();
}

bool index_has(Database& database, std::string_view sql, const ExperienceKey& key,
               std::int64_t id) {
  const auto query = database.cached(sql);
  return query->bind_all(key.task_id, key.robot_id, id).step();
}

bool is_in_use(Database& database, const ExperienceKey& key, std::int64_t id) {
  return index_has(database,
                   "SELECT 1 FROM path INDEXED BY path_by_task_robot "
                   "WHERE task_id = ? AND robot_id = ? AND id = ? AND retired_ms IS NULL",
                   key, id);
}

/// The robot and task of a path whose row may not be readable, as long as it is not retired.
std::optional<ExperienceKey> key_in_use(Database& database, std::int64_t id) {
  for (const ExperienceKey& key : select_experience(database, {}))
    if (is_in_use(database, key, id))
      return key;
  return std::nullopt;
}

/// Takes a path that is in use out of it.
void quarantine_path_in_use(Batch& batch, const ExperienceKey& key, std::int64_t id) {
  Database& database = batch.database();
  const bool was_quarantined = find_quarantined(database, "path", id).has_value();
  quarantine_row(database, "path", id);
  if (was_quarantined)
    return;
  uncount_paths(database, key, 1);
  batch.paths_changed(key.task_id, key.robot_id);
}

/// Reads the row of one path.
void take_path(Database& database, std::int64_t id, PathsRead& read) {
  static_cast<void>(can_read([&] {
    const auto query = database.cached("SELECT " + std::string(kPathColumns) +
                                       "FROM path WHERE id = ? AND " + database.is_intact("path"));
    if (query->bind(1, id).step())
      read.add(*query);
    else
      read.damaged.push_back(id);
    return true;
  }));
}

std::vector<std::int64_t> newest_paths(Database& database, std::int64_t count) {
  std::vector<std::int64_t> ids;
  const auto query = database.cached("SELECT id FROM path WHERE NOT " + in_quarantine("path") +
                                     " ORDER BY id DESC LIMIT ?");
  query->bind(1, count);
  while (query->step())
    ids.push_back(query->column_integer(0));
  return ids;
}

/// Its checksum goes on covering the rest of the row.
/// \return false if the row cannot be read, so that it cannot be written either.
bool remove_waypoints(Database& database, std::int64_t id) {
  return can_read([&] {
    std::uint32_t crc = 0;
    {
      const auto query = database.cached(
          "SELECT id, report_uuid, T_task_base, dof, waypoint_count, 2, 0, x'00' FROM path "
          "WHERE id = ? AND " +
          database.is_intact("path"));
      if (!query->bind(1, id).step())
        return false;
      crc = path_content_of(*query).crc();
    }
    Savepoint savepoint(database);
    database
        .cached(
            "UPDATE path SET retired_ms = ?, encoding = 2, crc32c = ?, waypoints = ? WHERE id = ?")
        ->bind_all(now_ms(), std::int64_t{crc}, Bytes(kNoWaypoints), id)
        .run();
    savepoint.keep();
    return true;
  });
}

}  // namespace

SameContent find_same(Database& database, const ExperienceKey& key, const Digest& content) {
  std::vector<std::int64_t> ids;
  {
    const auto query = database.cached(
        "SELECT id FROM path INDEXED BY path_by_content "
        "WHERE robot_id = ? AND task_id = ? AND content_sha256 = ? AND retired_ms IS NULL");
    query->bind_all(key.robot_id, key.task_id, Bytes(content.bytes));
    while (query->step())
      ids.push_back(query->column_integer(0));
  }
  SameContent same;
  for (const std::int64_t id : ids) {
    const std::optional<QuarantinedRow> quarantined = find_quarantined(database, "path", id);
    if (!quarantined && is_readable(database, id) && has_content(database, id, key, content))
      same.readable = id;
    else if (!quarantined)
      same.damaged.push_back(id);
    else if (!quarantined->replaced_by && !quarantined->retired)
      same.quarantined.push_back(id);
  }
  return same;
}

bool is_receipt_backed(Database& database, const ExperienceKey& key, std::int64_t id) {
  const std::optional<std::int64_t> row = row_in_use(database, "path", id);
  if (row && is_readable(database, *row))
    return true;
  const std::optional<QuarantinedRow> quarantined = find_quarantined(database, "path", id);
  return (quarantined && quarantined->retired) || is_retired(database, key, row.value_or(id));
}

bool is_retired(Database& database, const ExperienceKey& key, std::int64_t id) {
  return index_has(database,
                   "SELECT 1 FROM path INDEXED BY path_retired "
                   "WHERE task_id = ? AND robot_id = ? AND id = ? AND retired_ms IS NOT NULL",
                   key, id);
}

std::optional<std::int64_t> find_retired(Database& database, const ExperienceKey& key,
                                         const Uuid& report_uuid) {
  const auto ids = database.cached(
      "SELECT id FROM path INDEXED BY path_retired "
      "WHERE task_id = ? AND robot_id = ? AND retired_ms IS NOT NULL");
  ids->bind_all(key.task_id, key.robot_id);
  while (ids->step()) {
    const std::int64_t id = ids->column_integer(0);
    if (can_read([&] {
          const auto row = database.cached("SELECT report_uuid FROM path WHERE id = ? AND " +
                                           database.is_intact("path"));
          return row->bind(1, id).step() && id_of<Uuid>(row->column_blob(0)) == report_uuid;
        }))
      return id;
  }
  return std::nullopt;
}

std::set<KeptPath> select_largest(Database& database, const ExperienceKey& key,
                                  std::uint64_t limit) {
  const auto query = database.cached(
      "SELECT content_sha256, id FROM path INDEXED BY path_by_content "
      "WHERE robot_id = ? AND task_id = ? AND retired_ms IS NULL AND NOT " +
      in_quarantine("path") + " ORDER BY content_sha256 DESC LIMIT ?");
  query->bind_all(key.robot_id, key.task_id, static_cast<std::int64_t>(limit));
  std::set<KeptPath> largest;
  while (query->step())
    largest.insert({id_of<Digest>(query->column_blob(0)), query->column_integer(1)});
  return largest;
}

std::int64_t insert_path(Database& database, const NewPath& path,
                         std::optional<std::int64_t> scene_id, std::int64_t now_ms) {
  const PreparedPath& prepared = *path.from->path;
  const auto T_task_base = optional_pose_blob(path.from->attempt.T_task_base);
  const PathContent content = content_of(path, blob_or_null(T_task_base).value_or(Bytes()));
  const std::int64_t id =
      database.query("SELECT coalesce(max(id), 0) + 1 FROM path").front().column_integer(0);
  std::optional<std::int64_t> retired_ms;
  if (path.is_dropped || path.is_retired)
    retired_ms = now_ms;
  database.insert_into("path")
      ->bind_all(id, path.key.task_id, path.key.robot_id, content.report_uuid,
                 Bytes(prepared.content.bytes), content.waypoint_count, content.dof,
                 prepared.length, path.received_ms, retired_ms, scene_id, blob_or_null(T_task_base),
                 content.encoding, std::int64_t{content.crc()}, content.waypoints)
      .run();
  return id;
}

PathsRead select_path(Database& database, std::int64_t id) {
  PathsRead read;
  if (const auto row = row_in_use(database, "path", id))
    take_path(database, *row, read);
  return read;
}

void quarantine_paths(Batch& batch, const std::vector<std::int64_t>& paths) {
  Database& database = batch.database();
  for (const std::int64_t path : paths) {
    if (find_quarantined(database, "path", path))
      continue;
    if (const auto key = key_in_use(database, path))
      quarantine_path_in_use(batch, *key, path);
    else
      quarantine_row(database, "path", path);
  }
}

void retire_damaged(Batch& batch, const ExperienceKey& key, std::int64_t id) {
  if (is_in_use(batch.database(), key, id))
    quarantine_path_in_use(batch, key, id);
  retire_quarantined(batch.database(), id);
}

void write_damaged(Database& database, const ExperienceKey& key, const DamagedPath& path) {
  if (path.replaced_by || is_in_use(database, key, path.id))
    quarantine_row(database, "path", path.id, path.replaced_by);
  if (!path.replaced_by)
    retire_quarantined(database, path.id);
}

void drop_path(Database& database, const ExperienceKey& key, std::int64_t id) {
  if (!remove_waypoints(database, id))
    write_damaged(database, key, {.id = id});
}

bool is_path_decodable(Database& database, std::int64_t id) {
  return can_read([&] {
    const auto query = database.cached("SELECT " + std::string(kPathContentColumns) +
                                       "FROM path WHERE id = ? AND " + database.is_intact("path"));
    return query->bind(1, id).step() &&
           (path_content_of(*query).is_dropped() ? has_right_path_crc(*query)
                                                 : read_path_content(*query).has_value());
  });
}

std::vector<std::int64_t> find_damaged_paths(Database& database, std::int64_t count) {
  std::vector<std::int64_t> damaged;
  for (const std::int64_t id : newest_paths(database, count))
    if (!is_readable(database, id))
      damaged.push_back(id);
  return damaged;
}

}  // namespace kinship::store
