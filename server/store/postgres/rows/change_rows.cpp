#include "server/store/postgres/rows/change_rows.hpp"

#include <algorithm>
#include <string>

#include "proto/types/failure.hpp"
#include "server/store/values/codes.hpp"

namespace kinship::store::postgres {
namespace {

std::vector<Digest> digests(Connection& connection, std::string_view sql, std::string_view cursor) {
  std::vector<Digest> digests;
  for (const Row row : connection.query(sql, cursor))
    digests.push_back(id_of<Digest>(row.column_blob(0)));
  return digests;
}

std::vector<ChangedExperience> changed_experience(Connection& connection, std::string_view cursor) {
  std::vector<ChangedExperience> changed;
  for (const Row row : connection.query(
           "SELECT task.name, robot.digest, paths, generation, retired_generation, dropped"
           " FROM experience JOIN task ON task.id = task_id JOIN robot ON robot.id = robot_id"
           " WHERE experience.changed_in >= $1::text::xid8",
           cursor))
    changed.push_back({std::string(row.column_text(0)),
                       {.robot = id_of<Digest>(row.column_blob(1)),
                        .paths = static_cast<std::uint64_t>(row.column_integer(2)),
                        .generation = static_cast<std::uint64_t>(row.column_integer(3)),
                        .retired_generation = static_cast<std::uint64_t>(row.column_integer(4)),
                        .dropped = static_cast<std::uint64_t>(row.column_integer(5))}});
  return changed;
}

}  // namespace

StoreChanges changes_since(Connection& connection, std::string_view cursor) {
  StoreChanges changes;
  changes.cursor = connection.query("SELECT pg_snapshot_xmin(pg_current_snapshot())::text")
                       .front()
                       .column_text(0);
  if (cursor.empty())
    return changes;
  const auto is_digit = [](char letter) { return letter >= '0' && letter <= '9'; };
  if (!std::ranges::all_of(cursor, is_digit))
    throw Failure(ErrorCode::InvalidInput, "cursor of another listing");
  changes.experience = changed_experience(connection, cursor);
  changes.robots =
      digests(connection,
              "SELECT digest FROM robot WHERE changed_in >= $1::text::xid8"
              " UNION SELECT digest FROM gone_robot WHERE changed_in >= $1::text::xid8",
              cursor);
  changes.evicted =
      digests(connection,
              "SELECT digest FROM evicted_distribution WHERE evicted_in >= $1::text::xid8", cursor);
  return changes;
}

}  // namespace kinship::store::postgres
