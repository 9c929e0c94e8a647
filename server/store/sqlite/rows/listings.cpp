#include "server/store/sqlite/rows/listings.hpp"

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/rows/attempt_rows.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"
#include "server/store/tables/pages.hpp"
#include "server/store/tables/tasks.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store {
namespace {

/// The end of a SELECT of paths.
std::string newest_not_quarantined(const char* limit) {
  return "NOT " + in_quarantine("path") + " ORDER BY id DESC LIMIT " + limit;
}

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
        newest_not_quarantined("?4"));
    query->bind_all(key.task_id, key.robot_id, before_id, count);
    append_path_ids(*query, ids);
  }
  std::ranges::sort(ids, std::greater<>());
  if (std::ssize(ids) > count)
    ids.resize(static_cast<std::size_t>(count));
  return ids;
}

/// The same of all.
std::vector<std::int64_t> all_paths_before(Database& database, std::int64_t before_id,
                                           std::int64_t count) {
  std::vector<std::int64_t> ids;
  const auto query =
      database.cached("SELECT id FROM path WHERE id < ?1 AND " + newest_not_quarantined("?2"));
  query->bind_all(before_id, count);
  append_path_ids(*query, ids);
  return ids;
}

std::string are_intact(Database& database, std::initializer_list<std::string_view> tables) {
  std::string condition = "TRUE";
  for (const std::string_view table : tables)
    condition += " AND " + database.is_intact(table);
  return condition;
}

/// Nothing if it, its robot, task or attempt is damaged, or if it lost its attempt in a repair.
std::optional<PathSummary> select_path_summary(Database& database, std::int64_t id) try {
  const auto query =
      database.cached("SELECT " + std::string(kPathSummaryColumns) + std::string(kIsDropped) +
                      ", " + record_columns("attempt.") +
                      "FROM path CROSS JOIN robot ON robot.id = path.robot_id "
                      "CROSS JOIN task ON task.id = path.task_id "
                      "CROSS JOIN attempt ON attempt.id = (SELECT max(id) FROM attempt AS newest "
                      "WHERE newest.report_uuid = path.report_uuid) WHERE path.id = ? AND " +
                      are_intact(database, {"path", "robot", "task", "attempt"}));
  if (!query->bind(1, id).step())
    return std::nullopt;
  return read_path_summary(*query);
} catch (const SqliteError& error) {
  if (!error.is_damage())
    throw;
  return std::nullopt;
}

}  // namespace

Page<PathSummary> page_of_paths(Database& database, const PairFilter& filter,
                                std::string_view cursor, std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  const bool is_filtered = !filter.is_empty();
  const std::vector<ExperienceKey> keys =
      is_filtered ? select_experience(database, filter) : std::vector<ExperienceKey>();
  std::int64_t before_id = parse_falling_cursor(cursor);
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

Page<DistributionSummary> page_of_distributions(Database& database, const PairFilter& filter,
                                                std::string_view cursor, std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  std::vector<Parameter> parameters = {Parameter(parse_falling_cursor(cursor)),
                                       Parameter(rows + 1)};
  // Each fit is a row of its own: the greatest id is the newest fit.
  const std::string sql =
      "SELECT " + std::string(kDistributionSummaryColumns) +
      "FROM distribution JOIN robot ON robot.id = distribution.robot_id"
      " JOIN task ON task.id = distribution.task_id WHERE distribution.id < $1 AND " +
      are_intact(database, {"distribution", "robot", "task"}) + " AND NOT " +
      in_quarantine("distribution") + filter.condition(database, "distribution", parameters) +
      " ORDER BY distribution.id DESC LIMIT $2";
  return read_page<DistributionSummary>(
      database.query_with(sql, parameters), rows, read_distribution_summary<Row>,
      [](const Row& row) { return std::to_string(row.column_integer(kIdOfDistributionSummary)); });
}

void count_rows(Database& database, StoreStatus& status) {
  // A table that cannot be counted leaves the others their counts.
  const auto read = [&](std::string_view name, std::string_view sql, const auto& take) {
    try {
      const auto query = database.cached(sql);
      query->step();
      take(*query);
    } catch (const SqliteError& error) {
      if (!error.is_damage())
        throw;
      status.message += "damaged: the " + std::string(name) + " cannot be counted; ";
    }
  };
  const auto count = [&](std::uint64_t& into, std::string_view name, std::string_view sql) {
    read(name, sql, [&into](const auto& row) { into = count_of(row, 0); });
  };
  std::uint64_t schema = 0;
  count(status.robots, "robots", "SELECT count(*) FROM robot WHERE label NOT GLOB 'removed *'");
  count(status.tasks, "tasks", "SELECT count(*) FROM task WHERE " + is_listed_task(database));
  count(status.paths, "paths", "SELECT coalesce(sum(paths), 0) FROM experience");
  count(status.dropped_paths, "dropped paths", "SELECT coalesce(sum(dropped), 0) FROM experience");
  count(status.most_paths_of_pair, "paths of robots and tasks",
        "SELECT coalesce(max(paths), 0) FROM experience");
  count(status.attempts, "attempts", "SELECT coalesce(sum(attempts), 0) FROM experience");
  count(status.distributions, "distributions",
        "SELECT (SELECT count(*) FROM distribution) - "
        "(SELECT count(*) FROM quarantine WHERE of_table = 'distribution')");
  count(status.distribution_bytes, "sizes of distributions",
        "SELECT coalesce(sum(bytes), 0) FROM distribution_use "
        "INDEXED BY distribution_use_by_time");
  count(status.meshes, "meshes", "SELECT count(*) FROM mesh");
  count(status.mesh_bytes, "sizes of meshes", "SELECT coalesce(sum(length(payload)), 0) FROM mesh");
  read("measured attempts", kMeansOfAll, [&status](const auto& row) {
    status.guided_means = read_means(row, 0);
    status.control_means = read_means(row, kControlMeansOfAll);
  });
  count(schema, "schema", "SELECT user_version FROM pragma_user_version");
  count(status.bytes, "pages",
        "SELECT (SELECT page_count FROM pragma_page_count) *"
        " (SELECT page_size FROM pragma_page_size)");
  status.schema_version = static_cast<std::uint32_t>(schema);
  for (const QuarantineCount& quarantined : count_quarantined(database))
    if (quarantined.table != "distribution")  // these are fitted again
      status.message += std::to_string(quarantined.rows) + " damaged " + quarantined.table +
                        (quarantined.rows == 1 ? "" : "s") + " in quarantine; ";
}

}  // namespace kinship::store
