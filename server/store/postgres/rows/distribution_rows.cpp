#include "server/store/postgres/rows/distribution_rows.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "server/store/postgres/rows/task_rows.hpp"
#include "server/store/tables/audit.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/crc32c.hpp"
#include "server/store/values/distribution_blob.hpp"
#include "server/store/values/robot_columns.hpp"

namespace kinship::store::postgres {
namespace {

constexpr std::string_view kRevisionFloor = "revision_floor";
constexpr std::int64_t kHour_ms = 3'600'000;
constexpr std::int64_t kRestOfARow = 1024;  // bytes beside the payload, about

/// No distribution that made room for others had a greater revision.
std::int64_t revision_floor(Connection& connection) {
  const Rows rows =
      connection.query("SELECT value::bigint FROM setting WHERE key = $1", kRevisionFloor);
  return rows.empty() ? 0 : rows.front().column_integer(0);
}

void raise_revision_floor(Connection& connection, std::int64_t revision) {
  connection.query("UPDATE setting SET value = greatest(value::bigint, $2)::text WHERE key = $1",
                   kRevisionFloor, revision);
}

/// The greatest revision that an id had, evicted ones too; 0: none.
std::int64_t newest_revision(Connection& connection, const Digest& id) {
  const Rows rows = connection.query(
      "SELECT greatest((SELECT revision FROM distribution WHERE digest = $1),"
      " (SELECT revision FROM evicted_distribution WHERE digest = $1), 0)",
      Bytes(id.bytes));
  return rows.front().column_integer(0);
}

std::int64_t robot_id_of(Connection& connection, const Distribution& distribution) {
  const Rows rows = connection.query("SELECT id, label FROM robot WHERE digest = $1",
                                     Bytes(distribution.robot.bytes));
  if (rows.empty() || is_removed_label(rows.front().column_text(1)))
    throw Failure(ErrorCode::NotFound, "distribution " + distribution.id.short_hex() + ": robot " +
                                           distribution.robot.short_hex() + " is not registered");
  return rows.front().column_integer(0);
}

/// Each fit is a row of its own: the greatest id is the newest fit.
/// \return its row.
std::int64_t insert_row(Connection& connection, const Distribution& distribution,
                        std::int64_t revision, const std::vector<std::uint8_t>& payload) {
  const std::int64_t robot_id = robot_id_of(connection, distribution);
  std::uint64_t paths = 0;
  for (const Source& source : distribution.sources)
    paths += source.paths;
  const auto components = distribution.mixture ? distribution.mixture->size() : 0;
  const Rows rows = connection.query(
      "INSERT INTO distribution (digest, revision, task_id, robot_id, profile, state, reason,"
      " components, configurations, paths, fitted_ms, crc32c, payload) "
      "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13) RETURNING id",
      Bytes(distribution.id.bytes), revision, ensure_task(connection, distribution.task), robot_id,
      distribution.profile, code_of(distribution.state), distribution.reason,
      std::int64_t{components}, static_cast<std::int64_t>(distribution.configurations),
      static_cast<std::int64_t>(paths), distribution.fitted_ms, std::int64_t{crc32c(payload)},
      payload);
  const std::int64_t row = rows.front().column_integer(0);
  connection.query("INSERT INTO distribution_use (id, used_ms, bytes) VALUES ($1, $2, $3)", row,
                   now_ms(), kRestOfARow + std::ssize(payload));
  return row;
}

/// Deletes those not used for longest, but not this one.
void make_room_beside(Connection& connection, std::int64_t row, std::uint64_t max_bytes) {
  const std::uint64_t bytes = bytes_of_distributions(connection);
  if (bytes <= max_bytes)
    return;
  // Not many at once: after the limit was lowered others go on.
  const Rows gone = connection.query(
      "DELETE FROM distribution WHERE id = ANY (ARRAY (SELECT id FROM "
      "(SELECT id, coalesce(sum(bytes) OVER (ORDER BY used_ms, id ROWS BETWEEN UNBOUNDED PRECEDING"
      " AND 1 PRECEDING), 0) AS bytes_before FROM "
      "(SELECT id, used_ms, bytes FROM distribution_use WHERE id <> $1 ORDER BY used_ms, id"
      " LIMIT 64) AS oldest) AS summed WHERE bytes_before < $2)) RETURNING revision",
      row, static_cast<std::int64_t>(bytes - max_bytes));
  std::int64_t newest = 0;
  for (const Row revision : gone)
    newest = std::max(newest, revision.column_integer(0));
  raise_revision_floor(connection, newest);
}

void forget_eviction(Connection& connection, const Digest& id) {
  connection.query("DELETE FROM evicted_distribution WHERE digest = $1", Bytes(id.bytes));
}

}  // namespace

void lock_distributions(Connection& connection) {
  connection.query("INSERT INTO setting (key, value) VALUES ($1, '0') ON CONFLICT DO NOTHING",
                   kRevisionFloor);
  connection.query("SELECT 1 FROM setting WHERE key = $1 FOR UPDATE", kRevisionFloor);
}

std::uint64_t upsert_distribution(Connection& connection, const Distribution& distribution,
                                  std::uint64_t max_bytes) {
  const std::vector<std::uint8_t> payload = encode_distribution(distribution);
  if (!decode_distribution(payload))
    throw Failure(ErrorCode::InvalidInput, "distribution " + distribution.id.short_hex() +
                                               ": exceeds a limit and could not be read back");
  lock_distributions(connection);
  const std::int64_t revision =
      std::max(revision_floor(connection), newest_revision(connection, distribution.id)) + 1;
  connection.query("DELETE FROM distribution WHERE digest = $1", Bytes(distribution.id.bytes));
  const std::int64_t row = insert_row(connection, distribution, revision, payload);
  forget_eviction(connection, distribution.id);
  if (max_bytes > 0)
    make_room_beside(connection, row, max_bytes);
  return static_cast<std::uint64_t>(revision);
}

void note_use(Connection& connection, const Digest& id) {
  connection.query(
      "UPDATE distribution_use SET used_ms = $1 FROM distribution WHERE digest = $2 AND"
      " distribution_use.id = distribution.id AND used_ms < $1 - $3",
      now_ms(), Bytes(id.bytes), kHour_ms);
}

std::uint64_t bytes_of_distributions(Connection& connection) {
  const Rows rows =
      connection.query("SELECT coalesce(sum(bytes), 0)::bigint FROM distribution_use");
  return count_of(rows.front(), 0);
}

bool delete_distribution(Connection& connection, const Digest& id) {
  lock_distributions(connection);
  const Rows gone = connection.query(
      "DELETE FROM distribution WHERE digest = $1 RETURNING revision", Bytes(id.bytes));
  if (gone.empty())
    return false;
  connection.query(
      "INSERT INTO evicted_distribution (digest, revision, evicted_ms) VALUES ($1, $2, $3) "
      "ON CONFLICT (digest) DO UPDATE SET evicted_ms = excluded.evicted_ms,"
      " evicted_in = excluded.evicted_in,"
      " revision = greatest(evicted_distribution.revision, excluded.revision)",
      Bytes(id.bytes), gone.front().column_integer(0), now_ms());
  return true;
}

DistributionRead select_distribution(Connection& connection, const Digest& id) {
  const Rows rows = connection.query(
      "SELECT revision, crc32c, payload FROM distribution WHERE digest = $1", Bytes(id.bytes));
  if (rows.empty())
    return {};
  const Row row = rows.front();
  const Bytes payload = row.column_blob(2);
  if (crc32c(payload) != row.column_integer(1))
    return {std::nullopt, true};
  std::optional<Distribution> distribution = decode_distribution(payload);
  if (!distribution || distribution->id != id)
    return {std::nullopt, true};
  distribution->revision = count_of(row, 0);
  return {std::move(distribution), false};
}

bool evict_audited(Connection& connection, const Digest& id, const AuditEntry* audit) {
  std::string before;
  if (audit != nullptr)
    if (const auto known = select_distribution(connection, id).distribution)
      before = describe_distribution(*known);
  const bool was_there = delete_distribution(connection, id);
  if (was_there)
    note_act(connection, audit, AuditOutcome::Done, std::move(before), "gone");
  return was_there;
}

}  // namespace kinship::store::postgres
