#include "server/store/postgres/rows/store_totals.hpp"

#include <array>
#include <string>

#include "server/store/values/audit_texts.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store::postgres {
namespace {

constexpr std::string_view kCounts =
    "SELECT (SELECT count(*) FROM robot WHERE label NOT LIKE 'removed %'),"
    " (SELECT count(*) FROM task), count(*), coalesce(sum(bytes), 0)::bigint,"
    " (SELECT max(version) FROM schema_migration) FROM distribution_use";

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

void count_rows(Connection& connection, StoreStatus& status) {
  const std::array<Request, 4> requests = {Request{kCounts}, Request{kPairs}, Request{kDamaged},
                                           Request{kBytes}};
  const std::vector<Rows> rows = connection.query_all(requests);
  const Row counts = rows[0].front(), pairs = rows[1].front(), damaged = rows[2].front();
  status.robots = count_of(counts, 0);
  status.tasks = count_of(counts, 1);
  status.distributions = count_of(counts, 2);
  status.distribution_bytes = count_of(counts, 3);
  status.schema_version = static_cast<std::uint32_t>(counts.column_integer(4));
  status.paths = count_of(pairs, 0);
  status.attempts = count_of(pairs, 1);
  status.dropped_paths = count_of(pairs, 2);
  status.most_paths_of_pair = count_of(pairs, 3);
  status.bytes = count_of(rows[3].front(), 0);
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
