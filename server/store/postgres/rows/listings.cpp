#include "server/store/postgres/rows/listings.hpp"

#include <array>
#include <string>
#include <vector>

#include "server/store/tables/pages.hpp"
#include "server/store/tables/tasks.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store::postgres {
namespace {

/// The ids of the newest paths before $1, at most $2: of all along the table; of some robots and
/// tasks each brings its own, read from its indexes.
std::string newest_paths(Session& session, const PairFilter& filter,
                         std::vector<Parameter>& parameters) {
  if (filter.is_empty())
    return "SELECT id FROM path WHERE id < $1 AND damaged_ms IS NULL ORDER BY id DESC LIMIT $2";
  const std::string of_pair =
      "SELECT id FROM path WHERE task_id = experience.task_id AND"
      " robot_id = experience.robot_id AND id < $1 AND damaged_ms IS NULL AND ";
  const std::string newest = " ORDER BY id DESC LIMIT $2";
  return "SELECT newest.id FROM experience CROSS JOIN LATERAL ((" + of_pair + "retired_ms IS NULL" +
         newest + ") UNION ALL (" + of_pair + "retired_ms IS NOT NULL" + newest +
         ")) AS newest WHERE TRUE" + filter.condition(session, "experience", parameters) +
         " ORDER BY newest.id DESC LIMIT $2";
}

/// The same for distributions. In the order of one index alone, so that no other one is read to its
/// end for rows that do not exist: the rows below, without the ones not asked for.
std::string newest_distributions(Session& session, const PairFilter& filter,
                                 std::vector<Parameter>& parameters) {
  std::string columns, ids, falling, are_asked_for;
  for (const PairFilter::Column& column : filter.columns(session, parameters)) {
    columns += column.name + ", ";
    ids += column.id + ", ";
    falling += column.name + " DESC, ";
    are_asked_for += " AND " + column.name + " = " + column.id;
  }
  return "SELECT id FROM (SELECT " + columns + "id FROM distribution WHERE (" + columns +
         "id) < (" + ids + "$1) ORDER BY " + falling + "id DESC LIMIT $2) AS below WHERE TRUE" +
         are_asked_for;
}

std::string counts_of_all(Connection& connection) {
  return "SELECT (SELECT count(*) FROM robot WHERE label NOT LIKE 'removed %'),"
         " (SELECT count(*) FROM task WHERE " +
         is_listed_task(connection) +
         "), count(*), coalesce(sum(bytes), 0)::bigint,"
         " (SELECT max(version) FROM schema_migration), (SELECT count(*) FROM mesh),"
         " (SELECT coalesce(sum(length(payload)), 0)::bigint FROM mesh) FROM distribution_use";
}

constexpr std::string_view kPairs =
    "SELECT coalesce(sum(paths), 0)::bigint, coalesce(sum(attempts), 0)::bigint,"
    " coalesce(sum(dropped), 0)::bigint, coalesce(max(paths), 0) FROM experience";

constexpr std::string_view kDamaged =
    "SELECT (SELECT count(*) FROM path WHERE damaged_ms IS NOT NULL AND replaced_by IS NULL"
    "  AND retired_ms IS NULL),"
    " (SELECT count(*) FROM scene WHERE damaged_ms IS NOT NULL)";

// The sizes of the files, without a look into them.
constexpr std::string_view kBytes =
    "SELECT coalesce(sum(pg_total_relation_size(oid)), 0)::bigint FROM pg_class"
    " WHERE relkind = 'r' AND relnamespace ="
    "  (SELECT relnamespace FROM pg_class WHERE oid = 'schema_migration'::regclass)";

}  // namespace

Page<PathSummary> page_of_paths(Connection& connection, const PairFilter& filter,
                                std::string_view cursor, std::size_t limit) {
  constexpr int kId = kRecordOfPathSummary + kRecordColumns;
  const std::int64_t rows = rows_of_page(limit);
  std::vector<Parameter> parameters = {Parameter(parse_falling_cursor(cursor)),
                                       Parameter(rows + 1)};
  const std::string page = newest_paths(connection, filter, parameters);
  return read_page<PathSummary>(
      connection.query_with("SELECT " + std::string(kPathSummaryColumns) + std::string(kIsDropped) +
                                ", " + record_columns("attempt.") + ", path.id FROM (" + page +
                                ") AS page CROSS JOIN LATERAL (SELECT * FROM path AS found"
                                " WHERE found.id = page.id OFFSET 0) AS path "
                                "JOIN robot ON robot.id = path.robot_id "
                                "JOIN task ON task.id = path.task_id "
                                "CROSS JOIN LATERAL (SELECT * FROM attempt AS found"
                                " WHERE found.report_uuid = path.report_uuid OFFSET 0) AS attempt "
                                "ORDER BY path.id DESC",
                            parameters),
      rows, read_path_summary<store::Row>,
      [](const store::Row& row) { return std::to_string(row.column_integer(kId)); });
}

Page<DistributionSummary> page_of_distributions(Connection& connection, const PairFilter& filter,
                                                std::string_view cursor, std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  std::vector<Parameter> parameters = {Parameter(parse_falling_cursor(cursor)),
                                       Parameter(rows + 1)};
  const std::string page = newest_distributions(connection, filter, parameters);
  return read_page<DistributionSummary>(
      connection.query_with("SELECT " + std::string(kDistributionSummaryColumns) + "FROM (" + page +
                                ") AS page CROSS JOIN LATERAL (SELECT * FROM distribution AS found"
                                " WHERE found.id = page.id OFFSET 0) AS distribution "
                                "JOIN robot ON robot.id = distribution.robot_id "
                                "JOIN task ON task.id = distribution.task_id "
                                "ORDER BY distribution.id DESC",
                            parameters),
      rows, read_distribution_summary<store::Row>, [](const store::Row& row) {
        return std::to_string(row.column_integer(kIdOfDistributionSummary));
      });
}

void count_rows(Connection& connection, StoreStatus& status) {
  const std::string of_all = counts_of_all(connection);
  const std::array<Request, 5> requests = {Request{of_all}, Request{kPairs}, Request{kDamaged},
                                           Request{kBytes}, Request{kMeansOfAll}};
  const std::vector<Rows> rows = connection.query_all(requests);
  const Row counts = rows[0].front(), pairs = rows[1].front(), damaged = rows[2].front();
  status.robots = count_of(counts, 0);
  status.tasks = count_of(counts, 1);
  status.distributions = count_of(counts, 2);
  status.distribution_bytes = count_of(counts, 3);
  status.schema_version = static_cast<std::uint32_t>(counts.column_integer(4));
  status.meshes = count_of(counts, 5);
  status.mesh_bytes = count_of(counts, 6);
  status.paths = count_of(pairs, 0);
  status.attempts = count_of(pairs, 1);
  status.dropped_paths = count_of(pairs, 2);
  status.most_paths_of_pair = count_of(pairs, 3);
  status.bytes = count_of(rows[3].front(), 0);
  const Row means = rows[4].front();
  status.guided_means = read_means(means, 0);
  status.control_means = read_means(means, kControlMeansOfAll);
  const std::int64_t paths = damaged.column_integer(0), scenes = damaged.column_integer(1);
  status.damaged = paths + scenes > 0;
  if (paths > 0)
    status.message += in_number(paths, "damaged path") + "; ";
  if (scenes > 0)
    status.message += in_number(scenes, "damaged scene") + "; ";
  if (status.damaged)
    status.message += "clients that report again mend them; ";
}

}  // namespace kinship::store::postgres
