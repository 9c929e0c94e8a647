#include "server/store/sqlite/rows/export_rows.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/rows/arrival_order.hpp"
#include "server/store/sqlite/rows/attempt_rows.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/scene_rows.hpp"
#include "server/store/sqlite/rows/set_aside_rows.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/pages.hpp"

namespace kinship::store {
namespace {

/// Nothing if its robot is removed, or it lies on a damaged page.
std::optional<AttemptSummary> read_summary(Database& database,
                                           const std::map<std::int64_t, RobotName>& names,
                                           std::int64_t id) {
  try {
    AttemptRow row = select_attempt(database, id);
    name_robot_and_task(database, row);
    if (row.is_robot_removed)
      return std::nullopt;
    const auto robot = names.find(row.robot_id);
    return AttemptSummary{row.attempt.report_uuid,
                          row.attempt.robot,
                          robot == names.end() ? "" : robot->second.label,
                          std::move(row.attempt.task),
                          std::move(row.attempt.machine),
                          std::move(row.attempt.record),
                          row.received_ms};
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    return std::nullopt;
  }
}

/// Nothing if its robot is removed, or it lies on a damaged page, which is noted.
std::optional<AttemptRow> read_row(Database& database, std::int64_t id, ExportRead& noted) {
  std::optional<AttemptRow> row = select_named(database, id);
  if (!row)
    noted.damaged.attempts.push_back(id);
  if (row && row->is_robot_removed)
    return std::nullopt;
  return row;
}

/// Nothing if its path is retired or damaged; a path or scene found damaged now is noted.
std::optional<Attempt> read_candidate(Database& database, std::int64_t id, ExportRead& noted) {
  std::optional<AttemptRow> row = read_row(database, id, noted);
  if (!row)
    return std::nullopt;
  if (row->path_id) {
    const std::optional<std::int64_t> path_id =
        row_in_use(database, AsideKind::Path, *row->path_id);
    if (!path_id || is_retired(database, {row->task_id, row->robot_id}, *path_id))
      return std::nullopt;
    PathsRead read = select_path(database, *path_id);
    noted.damaged.paths.insert(noted.damaged.paths.end(), read.damaged.begin(), read.damaged.end());
    if (!read.paths.empty())
      row->attempt.path = std::move(read.paths.front().path);
  }
  if (row->attempt.path.has_value() != (row->attempt.record.outcome == Outcome::Solved))
    return std::nullopt;
  if (row->scene_id) {
    SceneRead read = select_current_scene(database, *row->scene_id);
    if (read.damaged)
      noted.damaged.scenes.push_back(*row->scene_id);
    row->attempt.scene = std::move(read.scene);
  }
  return std::move(row->attempt);
}

}  // namespace

ExportRead export_page(Database& database, const std::optional<Digest>& robot,
                       std::string_view task, std::string_view cursor, std::size_t limit,
                       std::size_t max_bytes) {
  constexpr std::int64_t kCandidates = 64;
  const std::size_t rows = std::max<std::size_t>(limit, 1);
  ExportRead read;
  std::int64_t last_id = parse_rising_cursor(cursor);
  std::size_t bytes = 0;
  while (true) {
    const std::vector<std::int64_t> candidates =
        next_attempts(database, robot, task, last_id, kCandidates);
    if (candidates.empty())
      return read;
    for (const std::int64_t id : candidates) {
      if (std::optional<Attempt> attempt = read_candidate(database, id, read)) {
        const BatchBytes more = batch_bytes(*attempt);
        bytes += more.waypoints + more.scenes;
        if (read.page.rows.size() == rows || (!read.page.rows.empty() && bytes > max_bytes)) {
          read.page.next_cursor = std::to_string(last_id);
          return read;
        }
        read.page.rows.push_back(std::move(*attempt));
      }
      last_id = id;
    }
  }
}

Page<AttemptSummary> page_of_attempts(Database& database, const std::optional<Digest>& robot,
                                      std::string_view task, std::string_view cursor,
                                      std::size_t limit) {
  const auto rows = static_cast<std::int64_t>(std::max<std::size_t>(limit, 1));
  const std::map<std::int64_t, RobotName> names = select_robot_names(database);
  Page<AttemptSummary> page;
  std::int64_t last_id = parse_rising_cursor(cursor);
  while (true) {
    const std::int64_t more = rows - std::ssize(page.rows) + 1;  // one says whether a page follows
    const std::vector<std::int64_t> ids = next_attempts(database, robot, task, last_id, more);
    if (ids.empty())
      return page;
    for (const std::int64_t id : ids) {
      if (std::ssize(page.rows) == rows) {
        page.next_cursor = std::to_string(last_id);
        return page;
      }
      if (std::optional<AttemptSummary> summary = read_summary(database, names, id))
        page.rows.push_back(std::move(*summary));
      last_id = id;
    }
  }
}

}  // namespace kinship::store
