#include "server/store/sqlite/rows/distribution_rows.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/rows/attempt_rows.hpp"
#include "server/store/sqlite/rows/set_aside_rows.hpp"
#include "server/store/tables/audit.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/crc32c.hpp"
#include "server/store/values/distribution_blob.hpp"

namespace kinship::store {

namespace {

/// The rows of one id, as the index has them.
struct Revisions {
  std::optional<std::int64_t> row;  ///< in use
  std::int64_t newest = 0;          ///< of all, evicted ones too; 0: none
};

constexpr std::string_view kRevisionFloor = "revision_floor";
constexpr std::int64_t kHour_ms = 3'600'000;
constexpr std::int64_t kRestOfARow = 1024;  // bytes beside the payload, about

/// No distribution that made room for others had a greater one.
std::int64_t revision_floor(Database& database) {
  const auto query = database.cached("SELECT CAST (value AS INTEGER) FROM setting WHERE key = ?");
  return query->bind(1, kRevisionFloor).step() ? query->column_integer(0) : 0;
}

void raise_revision_floor(Database& database, std::int64_t revision) {
  if (revision > revision_floor(database))
    database
        .cached(
            "INSERT INTO setting VALUES (?, ?) ON CONFLICT (key) DO UPDATE"
            " SET value = excluded.value")
        ->bind_all(kRevisionFloor, std::string_view(std::to_string(revision)))
        .run();
}

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
  revisions.newest = std::max(revisions.newest, revision_floor(database));
  const auto query = database.cached("SELECT revision FROM evicted_distribution WHERE digest = ?");
  if (query->bind(1, Bytes(id.bytes)).step())
    revisions.newest = std::max(revisions.newest, query->column_integer(0));
  return revisions;
}

/// Deletes a row, or sets it aside if it cannot be read: SQLite frees the pages that it lies on.
void remove_row(Database& database, std::int64_t row) {
  database.cached("DELETE FROM distribution_use WHERE id = ?")->bind(1, row).run();
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
  if (!query->bind(1, Bytes(distribution.robot.bytes)).step() ||
      is_removed(database, distribution.robot))
    throw Failure(ErrorCode::NotFound, "distribution " + distribution.id.short_hex() + ": robot " +
                                           distribution.robot.short_hex() + " is not registered");
  return query->column_integer(0);
}

/// \return its row.
std::int64_t insert_row_of(Database& database, const Distribution& distribution,
                           std::int64_t revision, const std::vector<std::uint8_t>& payload) {
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
  const std::int64_t row = database.last_insert_id();
  database.cached("INSERT INTO distribution_use VALUES (?, ?, ?)")
      ->bind_all(row, now_ms(), kRestOfARow + std::ssize(payload))
      .run();
  return row;
}

/// The row not used for longest, but not this one, and about what it takes.
std::optional<std::pair<std::int64_t, std::int64_t>> oldest_but(Database& database,
                                                                std::int64_t row) {
  const auto query = database.cached(
      "SELECT id, bytes FROM distribution_use INDEXED BY distribution_use_by_time "
      "WHERE id <> ? ORDER BY used_ms, id LIMIT 1");
  if (!query->bind(1, row).step())
    return std::nullopt;
  return std::pair(query->column_integer(0), query->column_integer(1));
}

void make_room_beside(Database& database, std::int64_t row, std::uint64_t max_bytes) {
  constexpr int kMaxAtOnce = 64;  // after the limit was lowered others go on; the WAL stays small
  auto bytes = static_cast<std::int64_t>(bytes_of_distributions(database));
  for (int i = 0; i<kMaxAtOnce&& static_cast<std::uint64_t>(bytes)> max_bytes; ++i) {
    const auto oldest = oldest_but(database, row);
    if (!oldest)
      return;
    try {
      const auto query = database.cached("SELECT revision FROM distribution WHERE id = ?");
      if (query->bind(1, oldest->first).step())
        raise_revision_floor(database, query->column_integer(0));
    } catch (const SqliteError& error) {
      if (!error.is_damage())
        throw;  // it stays in the index, with its revision
    }
    remove_row(database, oldest->first);
    bytes -= oldest->second;
  }
}

void forget_eviction(Database& database, const Digest& id) {
  database.cached("DELETE FROM evicted_distribution WHERE digest = ?")
      ->bind(1, Bytes(id.bytes))
      .run();
}

}  // namespace

std::uint64_t upsert_distribution(Database& database, const Distribution& distribution,
                                  std::uint64_t max_bytes) {
  static_cast<void>(robot_id_of(database, distribution));
  const std::vector<std::uint8_t> payload = encode_distribution(distribution);
  if (!decode_distribution(payload))
    throw Failure(ErrorCode::InvalidInput, "distribution " + distribution.id.short_hex() +
                                               ": exceeds a limit and could not be read back");
  const Revisions revisions = revisions_of(database, distribution.id);
  if (revisions.row)
    remove_row(database, *revisions.row);
  const std::int64_t row = insert_row_of(database, distribution, revisions.newest + 1, payload);
  forget_eviction(database, distribution.id);
  if (max_bytes > 0)
    make_room_beside(database, row, max_bytes);
  return static_cast<std::uint64_t>(revisions.newest + 1);
}

void note_use(Database& database, const Digest& id) {
  if (const std::optional<std::int64_t> row = revisions_of(database, id).row) {
    const std::int64_t now = now_ms();
    database.cached("UPDATE distribution_use SET used_ms = ?1 WHERE id = ?2 AND used_ms < ?1 - ?3")
        ->bind_all(now, *row, kHour_ms)
        .run();
  }
}

std::uint64_t bytes_of_distributions(Database& database) {
  const auto query = database.cached(
      "SELECT coalesce(sum(bytes), 0) FROM distribution_use INDEXED BY distribution_use_by_time");
  return query->step() ? count_of(*query, 0) : 0;
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

bool evict_audited(Database& database, const Digest& id, const AuditEntry* audit) {
  std::string before;
  if (audit != nullptr)
    if (const auto known = select_distribution(database, id).distribution)
      before = describe_distribution(*known);
  const bool was_there = delete_distribution(database, id);
  if (was_there)
    note_act(database, audit, AuditOutcome::Done, std::move(before), "gone");
  return was_there;
}

}  // namespace kinship::store
