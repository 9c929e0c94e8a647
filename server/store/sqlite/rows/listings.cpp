#include "server/store/sqlite/rows/listings.hpp"

#include <algorithm>
#include <charconv>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/rows/attempt_rows.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/robot_rows.hpp"
#include "server/store/sqlite/rows/row_values.hpp"
#include "server/store/sqlite/rows/set_aside_rows.hpp"

namespace kinship::store {
namespace {

std::int64_t rows_of_page(std::size_t limit) {
  constexpr std::size_t kMaxRows = 10'000;
  return static_cast<std::int64_t>(std::clamp<std::size_t>(limit, 1, kMaxRows));
}

/// Reads up to `rows` rows; a row more says that another page follows.
/// \param read       makes a row of the statement.
/// \param cursor_of  the cursor that continues after the row at the statement.
template <typename Row, typename Read, typename CursorOf>
Page<Row> read_page(Statement& query, std::int64_t rows, Read read, CursorOf cursor_of) {
  Page<Row> page;
  std::string cursor;
  while (query.step()) {
    if (std::ssize(page.rows) == rows) {
      page.next_cursor = std::move(cursor);
      break;
    }
    page.rows.push_back(read(query));
    cursor = cursor_of(query);
  }
  return page;
}

[[noreturn]] void refuse_cursor(std::string_view cursor) {
  throw Failure(ErrorCode::InvalidInput,
                "cursor '" + std::string(cursor) + "' is not one of this listing");
}

/// The id of the last row shown; at the beginning one that no row reaches.
std::int64_t parse_id_cursor(std::string_view cursor) {
  std::int64_t id = std::numeric_limits<std::int64_t>::max();
  const char* const end = cursor.data() + cursor.size();
  const auto [after, error] = std::from_chars(cursor.data(), end, id);
  if (!cursor.empty() && (error != std::errc() || after != end || id < 0))
    refuse_cursor(cursor);
  return id;
}

/// What an arm's attempts cost, by three columns: attempts, solved, checks.
std::optional<ModeEvidence> evidence_of(const Statement& row, int first) {
  if (row.column_integer(first) == 0)
    return std::nullopt;
  ModeEvidence mode{count_of(row, first), count_of(row, first + 1)};
  if (mode.solved > 0)
    mode.checks_per_solution = row.column_real(first + 2) / static_cast<double>(mode.solved);
  return mode;
}

std::vector<TaskRobotSummary> robots_of_task(Database& database, RobotNames& names,
                                             std::int64_t task_id) {
  const auto query = database.cached(
      "SELECT robot_id, paths, attempts, generation, dropped,"
      " guided_attempts, guided_solved, guided_checks,"
      " control_attempts, control_solved, control_checks FROM experience WHERE task_id = ?");
  query->bind(1, task_id);
  constexpr int kGuided = 5, kControl = 8;
  std::vector<TaskRobotSummary> robots;
  while (query->step())
    if (const RobotNames::Name* const robot = names.find(query->column_integer(0));
        robot != nullptr && !is_removed_label(robot->label))
      robots.push_back({robot->digest, robot->label, count_of(*query, 1), count_of(*query, 2),
                        count_of(*query, 3), count_of(*query, 4), evidence_of(*query, kGuided),
                        evidence_of(*query, kControl)});
  std::ranges::sort(robots, {}, &TaskRobotSummary::label);
  return robots;
}

/// \param row  of task id and name.
TaskSummary read_task(Database& database, RobotNames& names, const Statement& row) {
  TaskSummary summary;
  summary.task = row.column_text(1);
  summary.robots = robots_of_task(database, names, row.column_integer(0));
  for (const TaskRobotSummary& robot : summary.robots) {
    summary.paths += robot.paths;
    summary.attempts += robot.attempts;
    summary.dropped += robot.dropped;
  }
  return summary;
}

PathSummary read_path_summary(const Statement& row) {
  constexpr int kFirstOfRecord = 11;
  PathSummary summary;
  summary.retired_ms = row.column_integer(0);  // NULL: 0
  summary.report_uuid = id_of<Uuid>(row.column_blob(1));
  summary.robot = id_of<Digest>(row.column_blob(2));
  summary.label = row.column_text(3);
  summary.task = row.column_text(4);
  summary.waypoints = count_of(row, 5);
  summary.length = row.column_real(6);
  summary.machine = row.column_text(7);
  summary.received_ms = row.column_integer(8);
  summary.T_task_base = pose_from_blob(row.column_blob(9));
  summary.dropped = row.column_integer(10) != 0;
  summary.record = read_record(row, kFirstOfRecord);
  return summary;
}

DistributionSummary read_distribution_summary(const Statement& row) {
  DistributionSummary summary;
  summary.id = id_of<Digest>(row.column_blob(0));
  summary.revision = count_of(row, 1);
  summary.task = row.column_text(2);
  summary.robot = id_of<Digest>(row.column_blob(3));
  summary.label = row.column_text(4);
  summary.profile = row.column_text(5);
  summary.state = state_of(row.column_integer(6));
  summary.reason = row.column_text(7);
  summary.components = count_of(row, 8);
  summary.configurations = count_of(row, 9);
  summary.paths = count_of(row, 10);
  summary.fitted_ms = row.column_integer(11);
  return summary;
}

AuditEntry read_audit_entry(const Statement& row) {
  constexpr std::int64_t kOutcomes = 4;
  AuditEntry entry;
  entry.number = count_of(row, 0);
  entry.time_ms = row.column_integer(1);
  entry.name = row.column_text(2);
  entry.role = row.column_text(3);
  entry.client = row.column_text(4);
  entry.is_local = row.column_integer(5) != 0;
  entry.verb = row.column_text(6);
  entry.target = row.column_text(7);
  entry.outcome =
      static_cast<AuditOutcome>(std::clamp<std::int64_t>(row.column_integer(8), 1, kOutcomes) - 1);
  entry.before = row.column_text(9);
  entry.after = row.column_text(10);
  entry.message = row.column_text(11);
  return entry;
}

/// The filters that a listing was asked for, as SQL; numbered parameters ?1 robot, ?2 task.
std::string filters(const std::optional<Digest>& robot, std::string_view task) {
  std::string sql;
  if (robot)
    sql += " AND robot.digest = ?1";
  if (!task.empty())
    sql += " AND task.name = ?2";
  return sql;
}

void bind_filters(Statement& query, const std::optional<Digest>& robot, std::string_view task) {
  if (robot)
    query.bind(1, Bytes(robot->bytes));
  if (!task.empty())
    query.bind(2, task);
}

constexpr std::string_view kNotAsidePath =
    "NOT EXISTS (SELECT 1 FROM set_aside WHERE kind = 1 AND set_aside.id = path.id) "
    "ORDER BY id DESC LIMIT ";

void append_path_ids(Statement& query, std::vector<std::int64_t>& ids) {
  while (query.step())
    ids.push_back(query.column_integer(0));
}

/// The newest undamaged paths before one, of some robots and tasks, retired ones too. Each brings
/// its own, read from its indexes; the newest of them all are the newest of all.
std::vector<std::int64_t> paths_before(Database& database, const std::vector<ExperienceKey>& keys,
                                       std::int64_t before_id, std::int64_t count) {
  std::vector<std::int64_t> ids;
  for (const ExperienceKey& key : keys) {
    const auto query = database.cached(
        "SELECT id FROM (SELECT id FROM path INDEXED BY path_by_task_robot WHERE task_id = ?1 AND "
        "robot_id = ?2 AND id < ?3 AND retired_ms IS NULL UNION ALL "
        "SELECT id FROM path INDEXED BY path_retired WHERE task_id = ?1 AND robot_id = ?2 "
        "AND id < ?3 AND retired_ms IS NOT NULL) AS path WHERE " +
        std::string(kNotAsidePath) + "?4");
    query->bind_all(key.task_id, key.robot_id, before_id, count);
    append_path_ids(*query, ids);
  }
  std::ranges::sort(ids, std::greater<>());
  if (std::ssize(ids) > count)
    ids.resize(static_cast<std::size_t>(count));
  return ids;
}

/// The same of all; where their rows cannot be read, from the indexes.
std::vector<std::int64_t> all_paths_before(Database& database, std::int64_t before_id,
                                           std::int64_t count) {
  try {
    std::vector<std::int64_t> ids;
    const auto query = database.cached("SELECT id FROM path WHERE id < ?1 AND " +
                                       std::string(kNotAsidePath) + "?2");
    query->bind_all(before_id, count);
    append_path_ids(*query, ids);
    return ids;
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    return paths_before(database, select_experience(database, {}, ""), before_id, count);
  }
}

/// Nothing if it lies on a damaged page, or lost its attempt in a repair.
std::optional<PathSummary> select_path_summary(Database& database, std::int64_t id) try {
  const auto query = database.cached(
      "SELECT path.retired_ms, path.report_uuid, robot.digest, robot.label,"
      " task.name, path.waypoint_count, path.length, attempt.machine, attempt.received_ms,"
      " path.T_task_base, " +
      std::string(kIsDropped) + ", " + std::string(kRecordColumns) +
      "FROM path CROSS JOIN robot ON robot.id = path.robot_id "
      "CROSS JOIN task ON task.id = path.task_id "
      "CROSS JOIN attempt ON attempt.id = (SELECT max(id) FROM attempt AS newest "
      "WHERE newest.report_uuid = path.report_uuid) WHERE path.id = ?");
  if (!query->bind(1, id).step())
    return std::nullopt;
  return read_path_summary(*query);
} catch (const SqliteError& error) {
  if (!error.is_damage())
    throw;
  return std::nullopt;
}

}  // namespace

Page<AuditEntry> page_of_audit(Database& database, std::string_view name, std::string_view cursor,
                               std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  const auto query = database.cached(
      "SELECT id, time_ms, name, role, client, is_local, verb, target, outcome, was, became,"
      " message FROM audit WHERE id < ?1 " +
      std::string(name.empty() ? "" : "AND name = ?3 ") + "ORDER BY id DESC LIMIT ?2");
  query->bind_all(parse_id_cursor(cursor), rows + 1);
  if (!name.empty())
    query->bind(3, name);
  return read_page<AuditEntry>(*query, rows, read_audit_entry, [](const Statement& row) {
    return std::to_string(row.column_integer(0));
  });
}

Page<RobotSummary> page_of_robots(Database& database, std::string_view cursor, std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  const auto query = database.cached(
      "SELECT digest, label, base_link, tip_link, dof, registered_ms,"
      " (SELECT coalesce(sum(paths), 0) FROM experience WHERE robot_id = robot.id),"
      " (SELECT coalesce(sum(attempts), 0) FROM experience WHERE robot_id = robot.id),"
      " (SELECT coalesce(max(taken_ms), 0) FROM robot_geometry WHERE robot_id = robot.id) "
      "FROM robot WHERE label > ? AND base_link <> '' AND label NOT GLOB 'removed *' "
      "ORDER BY label LIMIT ?");
  query->bind_all(cursor, rows + 1);  // without base link: a repair knew its name alone
  const auto read = [](const Statement& row) {
    RobotSummary summary;
    summary.robot = id_of<Digest>(row.column_blob(0));
    summary.label = row.column_text(1);
    summary.base_link = row.column_text(2);
    summary.tip_link = row.column_text(3);
    summary.dof = static_cast<std::uint32_t>(row.column_integer(4));
    summary.registered_ms = row.column_integer(5);
    summary.paths = count_of(row, 6);
    summary.attempts = count_of(row, 7);
    summary.geometry_ms = row.column_integer(8);
    return summary;
  };
  return read_page<RobotSummary>(
      *query, rows, read, [](const Statement& row) { return std::string(row.column_text(1)); });
}

Page<TaskSummary> page_of_tasks(Database& database, std::string_view cursor, std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  RobotNames names(database);
  const auto query =
      database.cached("SELECT id, name FROM task WHERE name > ? ORDER BY name LIMIT ?");
  query->bind_all(cursor, rows + 1);
  return read_page<TaskSummary>(
      *query, rows, [&](const Statement& row) { return read_task(database, names, row); },
      [](const Statement& row) { return std::string(row.column_text(1)); });
}

std::optional<TaskSummary> summary_of_task(Database& database, std::string_view task) {
  const auto query = database.cached("SELECT id, name FROM task WHERE name = ?");
  if (!query->bind(1, task).step())
    return std::nullopt;
  RobotNames names(database);
  return read_task(database, names, *query);
}

Page<PathSummary> page_of_paths(Database& database, const std::optional<Digest>& robot,
                                std::string_view task, std::string_view cursor, std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  const bool is_filtered = robot || !task.empty();
  const std::vector<ExperienceKey> keys =
      is_filtered ? select_experience(database, robot, task) : std::vector<ExperienceKey>();
  std::int64_t before_id = parse_id_cursor(cursor);
  Page<PathSummary> page;
  while (true) {
    const std::int64_t more = rows - std::ssize(page.rows) + 1;  // one says whether a page follows
    const std::vector<std::int64_t> ids = is_filtered
                                              ? paths_before(database, keys, before_id, more)
                                              : all_paths_before(database, before_id, more);
    if (ids.empty())
      return page;
    for (const std::int64_t id : ids) {
      if (std::ssize(page.rows) == rows) {
        page.next_cursor = std::to_string(before_id);
        return page;
      }
      if (std::optional<PathSummary> summary = select_path_summary(database, id))
        page.rows.push_back(std::move(*summary));
      before_id = id;
    }
  }
}

Page<DistributionSummary> page_of_distributions(Database& database,
                                                const std::optional<Digest>& robot,
                                                std::string_view task, std::string_view cursor,
                                                std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  const std::int64_t before_id = parse_id_cursor(cursor);
  // Each fit is a row of its own: the greatest id is the newest fit.
  const auto query = database.cached(
      "SELECT distribution.digest, revision, task.name, robot.digest, robot.label, profile, state,"
      " reason, components, configurations, paths, fitted_ms, distribution.id FROM distribution "
      "JOIN robot ON robot.id = distribution.robot_id JOIN task ON task.id = distribution.task_id "
      "WHERE distribution.id < ?3 AND NOT EXISTS "
      "(SELECT 1 FROM set_aside WHERE kind = 4 AND set_aside.id = distribution.id)" +
      filters(robot, task) + " ORDER BY distribution.id DESC LIMIT ?4");
  bind_filters(*query, robot, task);
  query->bind(3, before_id).bind(4, rows + 1);
  return read_page<DistributionSummary>(
      *query, rows, read_distribution_summary,
      [](const Statement& row) { return std::to_string(row.column_integer(12)); });
}

void count_rows(Database& database, StoreStatus& status) {
  // A table that cannot be counted leaves the others their counts.
  const auto count = [&](std::uint64_t& into, std::string_view name, std::string_view sql) {
    try {
      const auto query = database.cached(sql);
      query->step();
      into = count_of(*query, 0);
    } catch (const SqliteError& error) {
      if (!error.is_damage())
        throw;
      status.message += "damaged: the " + std::string(name) + " cannot be counted; ";
    }
  };
  std::uint64_t schema = 0;
  count(status.robots, "robots", "SELECT count(*) FROM robot WHERE label NOT GLOB 'removed *'");
  count(status.tasks, "tasks", "SELECT count(*) FROM task");
  count(status.paths, "paths", "SELECT coalesce(sum(paths), 0) FROM experience");
  count(status.dropped_paths, "dropped paths", "SELECT coalesce(sum(dropped), 0) FROM experience");
  count(status.most_paths_of_pair, "paths of robots and tasks",
        "SELECT coalesce(max(paths), 0) FROM experience");
  count(status.attempts, "attempts", "SELECT coalesce(sum(attempts), 0) FROM experience");
  count(status.distributions, "distributions",
        "SELECT (SELECT count(*) FROM distribution) - "
        "(SELECT count(*) FROM set_aside WHERE kind = 4)");
  count(status.distribution_bytes, "sizes of distributions",
        "SELECT coalesce(sum(bytes), 0) FROM distribution_use "
        "INDEXED BY distribution_use_by_time");
  count(schema, "schema", "SELECT user_version FROM pragma_user_version");
  count(status.bytes, "pages",
        "SELECT (SELECT page_count FROM pragma_page_count) *"
        " (SELECT page_size FROM pragma_page_size)");
  status.schema_version = static_cast<std::uint32_t>(schema);
  for (const AsideCount& aside : count_aside(database))
    // Distributions are fitted again; what lost its attempt is in use.
    if (aside.kind != AsideKind::Distribution && aside.kind != AsideKind::Orphan)
      status.message += std::to_string(aside.rows) + " damaged " +
                        std::string(name_of(aside.kind, aside.rows)) + " set aside; ";
}

}  // namespace kinship::store
