#include "server/store/sqlite/distribution_rows.hpp"

#include <vector>

#include "server/store/crc32c.hpp"
#include "server/store/sqlite/attempt_rows.hpp"
#include "server/store/sqlite/clock.hpp"
#include "server/store/sqlite/distribution_blob.hpp"
#include "server/store/sqlite/row_values.hpp"

namespace kinship::store {

std::uint64_t upsert_distribution(Database& database, const Distribution& distribution) {
  std::int64_t robot_id = 0;
  {
    const auto query = database.cached("SELECT id FROM robot WHERE digest = ?");
    if (!query->bind(1, Bytes(distribution.robot.bytes)).step())
      throw Failure(ErrorCode::NotFound, "distribution " + distribution.id.short_hex() +
                                             ": robot " + distribution.robot.short_hex() +
                                             " is not registered");
    robot_id = query->column_integer(0);
  }
  std::uint64_t paths = 0;
  for (const Source& source : distribution.sources)
    paths += source.paths;
  const std::vector<std::uint8_t> payload = encode_distribution(distribution);
  if (!decode_distribution(payload))
    throw Failure(ErrorCode::InvalidInput, "distribution " + distribution.id.short_hex() +
                                               ": exceeds a limit and could not be read back");
  const auto components = distribution.mixture ? distribution.mixture->size() : 0;
  const auto insert = database.cached(
      "INSERT INTO distribution (digest, revision, task_id, robot_id, profile, state, reason,"
      " components, configurations, paths, fitted_ms, crc32c, payload) "
      "VALUES (?1, 1 + coalesce((SELECT revision FROM evicted_distribution WHERE digest = ?1), 0),"
      " ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) "
      "ON CONFLICT (digest) DO UPDATE SET revision = revision + 1, task_id = excluded.task_id,"
      " robot_id = excluded.robot_id, profile = excluded.profile, state = excluded.state,"
      " reason = excluded.reason, components = excluded.components,"
      " configurations = excluded.configurations, paths = excluded.paths,"
      " fitted_ms = excluded.fitted_ms, crc32c = excluded.crc32c, payload = excluded.payload "
      "RETURNING revision");
  insert->bind_all(Bytes(distribution.id.bytes), ensure_task(database, distribution.task), robot_id,
                   std::string_view(distribution.profile), code_of(distribution.state),
                   std::string_view(distribution.reason), std::int64_t{components},
                   static_cast<std::int64_t>(distribution.configurations),
                   static_cast<std::int64_t>(paths), distribution.fitted_ms,
                   std::int64_t{crc32c(payload)}, Bytes(payload));
  insert->step();
  const std::uint64_t revision = count_of(*insert, 0);
  insert->run();
  database.cached("DELETE FROM evicted_distribution WHERE digest = ?")
      ->bind(1, Bytes(distribution.id.bytes))
      .run();
  return revision;
}

bool delete_distribution(Database& database, const Digest& id) {
  database
      .cached(
          "INSERT INTO evicted_distribution SELECT digest, revision, ? FROM distribution "
          "WHERE digest = ?")
      ->bind_all(now_ms(), Bytes(id.bytes))
      .run();
  database.cached("DELETE FROM distribution WHERE digest = ?")->bind(1, Bytes(id.bytes)).run();
  return database.changed_rows() > 0;
}

DistributionRead select_distribution(Database& database, const Digest& id) {
  const auto query =
      database.cached("SELECT revision, crc32c, payload FROM distribution WHERE digest = ?");
  if (!query->bind(1, Bytes(id.bytes)).step())
    return {};
  const Bytes payload = query->column_blob(2);
  if (crc32c(payload) != query->column_integer(1))
    return {std::nullopt, true};
  std::optional<Distribution> distribution = decode_distribution(payload);
  if (!distribution || distribution->id != id)
    return {std::nullopt, true};
  distribution->revision = count_of(*query, 0);
  return {std::move(distribution), false};
}

}  // namespace kinship::store
