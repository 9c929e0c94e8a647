#include "server/store/sqlite/rows/export_rows.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/rows/attempt_rows.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"
#include "server/store/sqlite/rows/retirement.hpp"
#include "server/store/sqlite/rows/scene_rows.hpp"
#include "server/store/tables/pages.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/tables/searches.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store {
namespace {

void append_ids(Statement& query, std::vector<std::int64_t>& ids) {
  while (query.step())
    ids.push_back(query.column_integer(0));
}

/// The next attempts of some robots and tasks by id. Each brings its own next ones, read from an
/// index; the oldest of them all are the next of all.
std::vector<std::int64_t> next_of(Database& database, const std::vector<ExperienceKey>& keys,
                                  std::int64_t after_id, std::int64_t count) {
  std::vector<std::int64_t> ids;
  for (const ExperienceKey& key : keys) {
    const auto query = database.cached(
        "SELECT id FROM attempt INDEXED BY attempt_by_task_robot "
        "WHERE task_id = ? AND robot_id = ? AND id > ? AND NOT " +
        in_quarantine("attempt") + " ORDER BY id LIMIT ?");
    query->bind_all(key.task_id, key.robot_id, after_id, count);
    append_ids(*query, ids);
  }
  std::ranges::sort(ids);
  if (std::ssize(ids) > count)
    ids.resize(static_cast<std::size_t>(count));
  return ids;
}

std::vector<std::int64_t> next_of_all(Database& database, std::int64_t after_id,
                                      std::int64_t count) {
  std::vector<std::int64_t> ids;
  const auto query = database.cached("SELECT id FROM attempt WHERE id > ? AND NOT " +
                                     in_quarantine("attempt") + " ORDER BY id LIMIT ?");
  query->bind_all(after_id, count);
  append_ids(*query, ids);
  return ids;
}

/// The next attempts by id, without quarantined ones: of a robot, a task, both, or all of them.
std::vector<std::int64_t> next_attempts(Database& database, const PairFilter& filter,
                                        std::int64_t after_id, std::int64_t count) {
  return filter.is_empty()
             ? next_of_all(database, after_id, count)
             : next_of(database, select_experience(database, filter), after_id, count);
}

/// Nothing if its robot is removed, or it is damaged.
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

/// Nothing if its robot is removed, or it is damaged, which is noted.
std::optional<AttemptRow> read_row(Database& database, std::int64_t id, DamagedRows& noted) {
  std::optional<AttemptRow> row = select_named(database, id, noted.attempts);
  if (row && row->is_robot_removed)
    return std::nullopt;
  return row;
}

/// Reads the path and the scene that an attempt names, and its search record; notes newly found
/// damage.
void read_contents(Database& database, AttemptRow& row, DamagedRows& noted) {
  if (row.path_id) {
    PathsRead read = select_path(database, *row.path_id);
    noted.paths.insert(noted.paths.end(), read.damaged.begin(), read.damaged.end());
    if (!read.paths.empty())
      row.attempt.path = std::move(read.paths.front().path);
  }
  if (row.scene_id) {
    SceneRead read = select_current_scene(database, *row.scene_id);
    if (read.damaged)
      noted.scenes.push_back(*row.scene_id);
    row.attempt.scene = std::move(read.scene);
  }
  row.attempt.search = select_search(database, row.attempt.report_uuid);
}

bool is_whole(const Attempt& attempt) {
  return attempt.path.has_value() == (attempt.record.outcome == Outcome::Solved);
}

/// Nothing if its path is retired or damaged.
std::optional<Attempt> read_candidate(Database& database, std::int64_t id, DamagedRows& noted) {
  std::optional<AttemptRow> row = read_row(database, id, noted);
  if (!row)
    return std::nullopt;
  if (row->path_id) {
    const std::optional<std::int64_t> path_id = row_in_use(database, "path", *row->path_id);
    if (!path_id || is_retired(database, {row->task_id, row->robot_id}, *path_id))
      return std::nullopt;
  }
  read_contents(database, *row, noted);
  if (!is_whole(row->attempt))
    return std::nullopt;
  return std::move(row->attempt);
}

/// A path that was dropped leaves the same index as one that was retired.
bool is_dropped(Database& database, std::int64_t path_id) {
  const auto query = database.cached("SELECT " + std::string(kIsDropped) +
                                     " FROM path WHERE id = ? AND " + database.is_intact("path"));
  return query->bind(1, path_id).step() && query->column_integer(0) != 0;
}

/// By its path: the list of retirements may have lost entries in a repair.
bool is_path_retired(Database& database, const ExperienceKey& key, std::int64_t path_id) {
  const std::int64_t id = row_in_use(database, "path", path_id).value_or(path_id);
  if (const std::optional<QuarantinedRow> quarantined = find_quarantined(database, "path", id))
    return quarantined->retired;
  return is_retired(database, key, id) && !is_dropped(database, id);
}

/// Nothing if it is damaged.
std::optional<ArrivedReport> read_arrived(Database& database, std::int64_t id) {
  try {
    ArrivedReport report;
    std::optional<std::int64_t> path_id;
    ExperienceKey key;
    {
      const auto query = database.cached(
          "SELECT report_uuid, task_id, robot_id, path_id, body_sha256 FROM attempt"
          " WHERE id = ? AND " +
          database.is_intact("attempt"));
      if (!query->bind(1, id).step())
        return std::nullopt;
      report.report_uuid = id_of<Uuid>(query->column_blob(0));
      key = {query->column_integer(1), query->column_integer(2)};
      if (!query->column_is_null(3))
        path_id = query->column_integer(3);
      report.body = id_of<Digest>(query->column_blob(4));
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
std::optional<ReplicatedReport> read_replicated(Database& database, const Uuid& report_uuid,
                                                DamagedRows& noted) {
  const ReportRows rows = find_report(database, report_uuid);
  std::optional<AttemptRow> row = rows.row ? read_row(database, *rows.row, noted) : std::nullopt;
  if (!row || row->attempt.report_uuid != report_uuid)  // the index led to another one
    return std::nullopt;
  const bool is_retired =
      is_report_retired(database, report_uuid) ||
      (row->path_id && is_path_retired(database, {row->task_id, row->robot_id}, *row->path_id));
  read_contents(database, *row, noted);
  if (!is_whole(row->attempt))
    return std::nullopt;
  return ReplicatedReport{std::move(row->attempt), select_body(database, *rows.row),
                          row->received_ms, is_retired};
}

}  // namespace

ExportRead export_page(Database& database, const PairFilter& filter, std::string_view cursor,
                       std::size_t limit, std::size_t max_bytes) {
  constexpr std::int64_t kCandidates = 64;
  const std::size_t rows = std::max<std::size_t>(limit, 1);
  ExportRead read;
  std::int64_t last_id = parse_rising_cursor(cursor);
  std::size_t bytes = 0;
  while (true) {
    const std::vector<std::int64_t> candidates =
        next_attempts(database, filter, last_id, kCandidates);
    if (candidates.empty())
      return read;
    for (const std::int64_t id : candidates) {
      if (std::optional<Attempt> attempt = read_candidate(database, id, read.damaged)) {
        const BatchBytes more = batch_bytes(*attempt);
        bytes += more.waypoints + more.scenes + more.searches;
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

Page<AttemptSummary> page_of_attempts(Database& database, const PairFilter& filter,
                                      std::string_view cursor, std::size_t limit) {
  const auto rows = static_cast<std::int64_t>(std::max<std::size_t>(limit, 1));
  const std::map<std::int64_t, RobotName> names = select_robot_names(database);
  Page<AttemptSummary> page;
  std::int64_t last_id = parse_rising_cursor(cursor);
  while (true) {
    const std::int64_t more = rows - std::ssize(page.rows) + 1;  // one says whether a page follows
    const std::vector<std::int64_t> ids = next_attempts(database, filter, last_id, more);
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

Result<Attempt> find_attempt(Database& database, const Uuid& report_uuid, DamagedRows& noted) {
  const ReportRows report = find_report(database, report_uuid);
  if (!report.row && report.damaged.empty()) {
    database.require_absent("attempt", "report_uuid", Parameter(report_uuid));
    return Error{ErrorCode::NotFound, "report " + report_uuid.text() + ": no such report"};
  }
  std::optional<AttemptRow> row = select_named(database, report.row, noted.attempts);
  if (row && row->attempt.report_uuid == report_uuid) {
    read_contents(database, *row, noted);
    return std::move(row->attempt);
  }
  return Error{ErrorCode::Storage,
               "report " + report_uuid.text() + ": its row is damaged; report it again to mend it"};
}

Feed<ArrivedReport> page_of_arrivals(Database& database, std::string_view task,
                                     std::string_view cursor, std::size_t limit) {
  Feed<ArrivedReport> feed;
  feed.cursor = cursor;
  std::vector<std::int64_t> ids = next_attempts(
      database, {.task = task}, parse_rising_cursor(cursor), static_cast<std::int64_t>(limit) + 1);
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

std::map<Uuid, Digest> select_known(Database& database, std::span<const Uuid> reports) {
  std::map<Uuid, Digest> known;
  for (const Uuid& report : reports)
    if (const ReportRows rows = find_report(database, report); rows.row)
      known.emplace(report, select_body(database, *rows.row));
  return known;
}

ReplicatedRead select_replicated(Database& database, std::span<const Uuid> reports,
                                 std::size_t max_bytes) {
  ReplicatedRead read;
  std::size_t bytes = 0;
  for (const Uuid& report : reports) {
    if (read.found.looked_at > 0 && bytes > max_bytes)
      return read;
    if (std::optional<ReplicatedReport> shared = read_replicated(database, report, read.damaged)) {
      const BatchBytes more = batch_bytes(shared->attempt);
      bytes += more.waypoints + more.scenes + more.searches;
      read.found.reports.push_back(std::move(*shared));
    }
    ++read.found.looked_at;
  }
  return read;
}

}  // namespace kinship::store
