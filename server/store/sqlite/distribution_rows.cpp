#include "server/store/sqlite/distribution_rows.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "server/store/crc32c.hpp"
#include "server/store/sqlite/attempt_rows.hpp"
#include "server/store/sqlite/clock.hpp"
#include "server/store/sqlite/distribution_blob.hpp"
#include "server/store/sqlite/row_values.hpp"
#include "server/store/sqlite/set_aside_rows.hpp"
#include "server/store/sqlite/sqlite_error.hpp"
#include "server/store/sqlite/transaction.hpp"

namespace kinship::store {

namespace {

/// The rows of one id, as the index has them.
struct Revisions {
  std::optional<std::int64_t> row;  ///< in use
  std::int64_t newest = 0;          ///< of all, evicted ones too; 0: none
};

Revisions revisions_of(Database& database, const Digest& id) {
  Revisions revisions;
  {
    const auto query = database.cached(
        "SELECT id, revision FROM distribution INDEXED BY distribution_by_digest "
        "WHERE digest = ?");
    query->bind(1, Bytes(id.bytes));
    while (query->step()) {
      if (!find_aside(database, AsideKind::Distribution, query->column_integer(0)))
        revisions.row = query->column_integer(0);
      revisions.newest = std::max(revisions.newest, query->column_integer(1));
    }
  }
  const auto query = database.cached("SELECT revision FROM evicted_distribution WHERE digest = ?");
  if (query->bind(1, Bytes(id.bytes)).step())
    revisions.newest = std::max(revisions.newest, query->column_integer(0));
  return revisions;
}

/// Deletes a row, or sets it aside if it cannot be read: SQLite frees the pages that it lies on.
void remove_row(Database& database, std::int64_t row) {
  try {
    Savepoint savepoint(database);
    database.cached("DELETE FROM distribution WHERE id = ?")->bind(1, row).run();
    savepoint.keep();
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    put_aside(database, AsideKind::Distribution, row);
  }
}

std::int64_t robot_id_of(Database& database, const Distribution& distribution) {
  const auto query = database.cached("SELECT id FROM robot WHERE digest = ?");
  if (!query->bind(1, Bytes(distribution.robot.bytes)).step())
    throw Failure(ErrorCode::NotFound, "distribution " + distribution.id.short_hex() + ": robot " +
                                           distribution.robot.short_hex() + " is not registered");
  return query->column_integer(0);
}

void insert_row_of(Database& database, const Distribution& distribution, std::int64_t revision,
                   const std::vector<std::uint8_t>& payload) {
  std::uint64_t paths = 0;
  for (const Source& source : distribution.sources)
    paths += source.paths;
  const auto components = distribution.mixture ? distribution.mixture->size() : 0;
  database
      .cached(
          "INSERT INTO distribution (digest, revision, task_id, robot_id, profile, state, reason,"
          " components, configurations, paths, fitted_ms, crc32c, payload) "
          "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      ->bind_all(Bytes(distribution.id.bytes), revision, ensure_task(database, distribution.task),
                 robot_id_of(database, distribution), std::string_view(distribution.profile),
                 code_of(distribution.state), std::string_view(distribution.reason),
                 std::int64_t{components}, static_cast<std::int64_t>(distribution.configurations),
                 static_cast<std::int64_t>(paths), distribution.fitted_ms,
                 std::int64_t{crc32c(payload)}, Bytes(payload))
      .run();
}

void forget_eviction(Database& database, const Digest& id) {
  database.cached("DELETE FROM evicted_distribution WHERE digest = ?")
      ->bind(1, Bytes(id.bytes))
      .run();
}

}  // namespace

std::uint64_t upsert_distribution(Database& database, const Distribution& distribution) {
  static_cast<void>(robot_id_of(database, distribution));
  const std::vector<std::uint8_t> payload = encode_distribution(distribution);
  if (!decode_distribution(payload))
    throw Failure(ErrorCode::InvalidInput, "distribution " + distribution.id.short_hex() +
                                               ": exceeds a limit and could not be read back");
  const Revisions revisions = revisions_of(database, distribution.id);
  if (revisions.row)
    remove_row(database, *revisions.row);
  insert_row_of(database, distribution, revisions.newest + 1, payload);
  forget_eviction(database, distribution.id);
  return static_cast<std::uint64_t>(revisions.newest + 1);
}

bool delete_distribution(Database& database, const Digest& id) {
  const Revisions revisions = revisions_of(database, id);
  if (!revisions.row)
    return false;
  forget_eviction(database, id);
  database.cached("INSERT INTO evicted_distribution VALUES (?, ?, ?)")
      ->bind_all(Bytes(id.bytes), revisions.newest, now_ms())
      .run();
  remove_row(database, *revisions.row);
  return true;
}

DistributionRead select_distribution(Database& database, const Digest& id) {
  const std::optional<std::int64_t> row = revisions_of(database, id).row;
  DistributionRead read = row ? read_distribution(database, *row) : DistributionRead();
  if (read.distribution && read.distribution->id != id)
    return {std::nullopt, true};
  return read;
}

DistributionRead read_distribution(Database& database, std::int64_t row) {
  try {
    const auto query =
        database.cached("SELECT revision, crc32c, payload FROM distribution WHERE id = ?");
    if (!query->bind(1, row).step())
      return {};
    const Bytes payload = query->column_blob(2);
    if (crc32c(payload) != query->column_integer(1))
      return {std::nullopt, true};
    std::optional<Distribution> distribution = decode_distribution(payload);
    if (!distribution)
      return {std::nullopt, true};
    distribution->revision = count_of(*query, 0);
    return {std::move(distribution), false};
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    return {std::nullopt, true};
  }
}

}  // namespace kinship::store
