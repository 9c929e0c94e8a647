#include "server/store/sqlite/rows/shared_rows.hpp"

#include <optional>
#include <string>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/rows/arrival_order.hpp"
#include "server/store/sqlite/rows/attempt_rows.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/retired_reports.hpp"
#include "server/store/sqlite/rows/scene_rows.hpp"
#include "server/store/sqlite/rows/set_aside_rows.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/pages.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store {
namespace {

/// A path that was dropped leaves the same index as one that was retired.
bool is_dropped(Database& database, std::int64_t path_id) {
  const auto query =
      database.cached("SELECT " + std::string(kIsDropped) + " FROM path WHERE id = ?");
  return query->bind(1, path_id).step() && query->column_integer(0) != 0;
}

/// By its path: the list of retirements may have lost entries in a repair.
bool is_path_retired(Database& database, const ExperienceKey& key, std::int64_t path_id) {
  const std::int64_t id = row_in_use(database, AsideKind::Path, path_id).value_or(path_id);
  if (const std::optional<Aside> aside = find_aside(database, AsideKind::Path, id))
    return aside->retired;
  return is_retired(database, key, id) && !is_dropped(database, id);
}

/// Nothing if it lies on a damaged page.
std::optional<ArrivedReport> read_arrived(Database& database, std::int64_t id) {
  try {
    ArrivedReport report;
    std::optional<std::int64_t> path_id;
    ExperienceKey key;
    {
      const auto query = database.cached(
          "SELECT report_uuid, task_id, robot_id, path_id FROM attempt WHERE id = ?");
      if (!query->bind(1, id).step())
        return std::nullopt;
      report.report_uuid = id_of<Uuid>(query->column_blob(0));
      key = {query->column_integer(1), query->column_integer(2)};
      if (!query->column_is_null(3))
        path_id = query->column_integer(3);
    }
    report.is_retired = is_report_retired(database, report.report_uuid) ||
                        (path_id && is_path_retired(database, key, *path_id));
    return report;
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    return std::nullopt;
  }
}

Digest select_body(Database& database, std::int64_t id) {
  const auto query = database.cached("SELECT body_sha256 FROM attempt WHERE id = ?");
  return query->bind(1, id).step() ? id_of<Digest>(query->column_blob(0)) : Digest();
}

/// Nothing if it is not whole any more.
std::optional<SharedReport> read_shared(Database& database, const Uuid& report_uuid,
                                        SharedRead& noted) {
  const ReportRows rows = find_report(database, report_uuid);
  if (!rows.row)
    return std::nullopt;
  std::optional<AttemptRow> row = select_named(database, rows.row);
  if (!row)
    noted.damaged.attempts.push_back(*rows.row);
  if (!row || row->is_robot_removed)
    return std::nullopt;
  SharedReport shared{std::move(row->attempt), select_body(database, *rows.row), row->received_ms,
                      is_report_retired(database, report_uuid)};
  if (row->path_id) {
    PathsRead paths = select_path(database, *row->path_id);
    noted.damaged.paths.insert(noted.damaged.paths.end(), paths.damaged.begin(),
                               paths.damaged.end());
    if (!paths.paths.empty())
      shared.attempt.path = std::move(paths.paths.front().path);
    shared.is_retired = shared.is_retired ||
                        is_path_retired(database, {row->task_id, row->robot_id}, *row->path_id);
  }
  if (shared.attempt.path.has_value() != (shared.attempt.record.outcome == Outcome::Solved))
    return std::nullopt;
  if (row->scene_id) {
    SceneRead scene = select_current_scene(database, *row->scene_id);
    if (scene.damaged)
      noted.damaged.scenes.push_back(*row->scene_id);
    shared.attempt.scene = std::move(scene.scene);
  }
  return shared;
}

}  // namespace

Feed<ArrivedReport> page_of_arrivals(Database& database, std::string_view task,
                                     std::string_view cursor, std::size_t limit) {
  Feed<ArrivedReport> feed;
  feed.cursor = cursor;
  std::vector<std::int64_t> ids =
      next_attempts(database, std::nullopt, task, parse_rising_cursor(cursor),
                    static_cast<std::int64_t>(limit) + 1);
  feed.has_more = ids.size() > limit;
  if (feed.has_more)
    ids.resize(limit);
  for (const std::int64_t id : ids) {
    if (const std::optional<ArrivedReport> report = read_arrived(database, id))
      feed.rows.push_back(*report);
    feed.cursor = std::to_string(id);
  }
  return feed;
}

std::set<Uuid> select_known(Database& database, std::span<const Uuid> reports) {
  std::set<Uuid> known;
  for (const Uuid& report : reports)
    if (find_report(database, report).row)
      known.insert(report);
  return known;
}

SharedRead select_shared(Database& database, std::span<const Uuid> reports, std::size_t max_bytes) {
  SharedRead read;
  std::size_t bytes = 0;
  for (const Uuid& report : reports) {
    if (read.found.looked_at > 0 && bytes > max_bytes)
      return read;
    if (std::optional<SharedReport> shared = read_shared(database, report, read)) {
      const BatchBytes more = batch_bytes(shared->attempt);
      bytes += more.waypoints + more.scenes;
      read.found.reports.push_back(std::move(*shared));
    }
    ++read.found.looked_at;
  }
  return read;
}

}  // namespace kinship::store
