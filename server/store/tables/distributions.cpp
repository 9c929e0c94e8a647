#include "server/store/tables/distributions.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "server/store/tables/audit.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/tables/settings.hpp"
#include "server/store/tables/tasks.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/crc32c.hpp"
#include "server/store/values/distribution_blob.hpp"
#include "server/store/values/experience_key.hpp"

namespace kinship::store {
namespace {

constexpr std::string_view kRevisionFloor = "revision_floor";
constexpr std::int64_t kHour_ms = 3'600'000;
constexpr std::int64_t kRestOfARow = 1024;  // bytes beside the payload, about

/// The rows of one id: a quarantined one stays beside the one that a later fit brought.
struct Revisions {
  std::optional<std::int64_t> row;  ///< in use
  std::int64_t newest = 0;          ///< of all, evicted ones too; 0: none
};

/// No distribution that made room for others had a greater one.
std::int64_t revision_floor(Session& session) {
  return session
      .find_integer("SELECT CAST(value AS bigint) FROM setting WHERE key = $1 AND " +
                        session.is_intact("setting"),
                    kRevisionFloor)
      .value_or(0);
}

/// From indexes.
Revisions revisions_of(Session& session, const Digest& id) {
  Revisions revisions{.row = {}, .newest = revision_floor(session)};
  for (const Row& row :
       session.query("SELECT id, revision, " + session.is_quarantined("distribution") +
                         " FROM distribution WHERE digest = $1",
                     id)) {
    if (row.column_integer(2) == 0)
      revisions.row = row.column_integer(0);
    revisions.newest = std::max(revisions.newest, row.column_integer(1));
  }
  const auto evicted =
      session.find_integer("SELECT revision FROM evicted_distribution WHERE digest = $1 AND " +
                               session.is_intact("evicted_distribution"),
                           id);
  revisions.newest = std::max(revisions.newest, evicted.value_or(0));
  return revisions;
}

/// Deletes a row, or quarantines it if it cannot be read: SQLite frees the pages that it lies on.
void remove_row(Session& session, std::int64_t row) {
  session.query("DELETE FROM distribution_use WHERE id = $1", row);
  if (!session.try_change("DELETE FROM distribution WHERE id = $1", row))
    session.query(session.dialect().quarantine_distribution, row, now_ms());
}

std::int64_t require_robot(Session& session, const Distribution& distribution) {
  const std::optional<std::int64_t> id = find_registered(session, distribution.robot);
  if (!id)
    throw Failure(ErrorCode::NotFound, "distribution " + distribution.id.short_hex() + ": robot " +
                                           distribution.robot.short_hex() + " is not registered");
  if (!session.find_integer(
          "SELECT 1 FROM robot WHERE id = $1 AND digest = $2 AND " + session.is_intact("robot"),
          *id, distribution.robot))
    throw Failure(ErrorCode::Storage, "distribution " + distribution.id.short_hex() + ": robot " +
                                          distribution.robot.short_hex() + ": its row is damaged");
  return *id;
}

/// It may have been renamed or removed during the fit.
std::int64_t require_task(Session& session, const Distribution& distribution) {
  if (const std::optional<std::int64_t> id = find_task(session, distribution.task))
    return *id;
  throw Failure(ErrorCode::NotFound, "distribution " + distribution.id.short_hex() +
                                         ": there is no task '" + distribution.task + "'");
}

/// Each fit is a row of its own: the greatest id is the newest fit.
/// \return its row.
std::int64_t insert_distribution(Session& session, const Distribution& distribution,
                                 const ExperienceKey& key, std::int64_t revision,
                                 const std::vector<std::uint8_t>& payload) {
  std::uint64_t paths = 0;
  for (const Source& source : distribution.sources)
    paths += source.paths;
  const auto components = distribution.mixture ? distribution.mixture->size() : 0;
  const std::optional<std::int64_t> row = session.find_integer(
      "INSERT INTO distribution (digest, revision, task_id, robot_id, profile, state, reason,"
      " components, configurations, paths, fitted_ms, crc32c, payload) "
      "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13) RETURNING id",
      distribution.id, revision, key.task_id, key.robot_id, distribution.profile,
      code_of(distribution.state), distribution.reason, components, distribution.configurations,
      paths, distribution.fitted_ms, crc32c(payload), payload);
  session.query("INSERT INTO distribution_use (id, used_ms, bytes) VALUES ($1, $2, $3)",
                row.value(), now_ms(), kRestOfARow + std::ssize(payload));
  return row.value();
}

/// Deletes the least recently used ones, but not this one.
void make_room_beside(Session& session, std::int64_t row, std::uint64_t max_bytes) {
  auto bytes = static_cast<std::int64_t>(bytes_of_distributions(session));
  const auto limit = static_cast<std::int64_t>(max_bytes);
  std::vector<std::int64_t> oldest;
  if (bytes > limit)
    // Not many at once: after the limit was lowered others go on.
    for (const Row& use : session.query("SELECT id, bytes FROM distribution_use WHERE id <> $1"
                                        " ORDER BY used_ms, id LIMIT 64",
                                        row)) {
      oldest.push_back(use.column_integer(0));
      bytes -= use.column_integer(1);
      if (bytes <= limit)
        break;
    }
  const std::int64_t floor = revision_floor(session);
  std::int64_t newest = floor;
  for (const std::int64_t id : oldest) {
    const auto revision = session.unless_damaged([&] {
      return session.find_integer("SELECT revision FROM distribution WHERE id = $1 AND " +
                                      session.is_intact("distribution"),
                                  id);
    });
    newest = std::max(newest, revision.value_or(0));
    remove_row(session, id);
  }
  if (newest > floor)
    write_setting(session, kRevisionFloor, std::to_string(newest));
}

void forget_eviction(Session& session, const Digest& id) {
  session.query("DELETE FROM evicted_distribution WHERE digest = $1", id);
}

DistributionRead read_where(Session& session, const std::string& condition,
                            const Parameter& parameter) {
  const auto read = session.unless_damaged([&]() -> std::optional<DistributionRead> {
    const Rows rows =
        session.query_with("SELECT revision, crc32c, payload FROM distribution WHERE " +
                               session.is_intact("distribution") + " AND id = " + condition,
                           std::span(&parameter, 1));
    if (rows.empty())
      return DistributionRead();
    const Row& row = rows.front();
    const Bytes payload = row.column_blob(2);
    if (crc32c(payload) != row.column_integer(1))
      return std::nullopt;
    std::optional<Distribution> distribution = decode_distribution(payload);
    if (!distribution)
      return std::nullopt;
    distribution->revision = count_of(row, 0);
    return DistributionRead{std::move(distribution), false};
  });
  return read.value_or(DistributionRead{std::nullopt, true});
}

}  // namespace

void lock_distributions(Session& session) {
  const std::string_view for_update = session.dialect().for_update;
  if (for_update.empty())
    return;
  session.query("INSERT INTO setting (key, value) VALUES ($1, '0') ON CONFLICT DO NOTHING",
                kRevisionFloor);
  session.query("SELECT 1 FROM setting WHERE key = $1" + std::string(for_update), kRevisionFloor);
}

std::uint64_t upsert_distribution(Session& session, const Distribution& distribution,
                                  std::uint64_t max_bytes) {
  const std::vector<std::uint8_t> payload = encode_distribution(distribution);
  const bool can_be_read = decode_distribution(payload).has_value();
  lock_distributions(session);
  const std::int64_t robot_id = require_robot(session, distribution);
  const ExperienceKey key{require_task(session, distribution), robot_id};
  if (!can_be_read)
    throw Failure(ErrorCode::InvalidInput, "distribution " + distribution.id.short_hex() +
                                               ": exceeds a limit and could not be read back");
  const Revisions revisions = revisions_of(session, distribution.id);
  if (revisions.row)
    remove_row(session, *revisions.row);
  const std::int64_t revision = revisions.newest + 1;
  const std::int64_t row = insert_distribution(session, distribution, key, revision, payload);
  forget_eviction(session, distribution.id);
  if (max_bytes > 0)
    make_room_beside(session, row, max_bytes);
  return static_cast<std::uint64_t>(revision);
}

void note_use(Session& session, const Digest& id) {
  session.query(
      "UPDATE distribution_use SET used_ms = $1 WHERE used_ms < $1 - $3"
      " AND id = (SELECT max(id) FROM distribution WHERE digest = $2)",
      now_ms(), id, kHour_ms);
}

std::uint64_t bytes_of_distributions(Session& session) {
  return static_cast<std::uint64_t>(
      session.find_integer("SELECT CAST(coalesce(sum(bytes), 0) AS bigint) FROM distribution_use")
          .value_or(0));
}

bool delete_distribution(Session& session, const Digest& id) {
  lock_distributions(session);
  const Revisions revisions = revisions_of(session, id);
  if (!revisions.row)
    return false;
  forget_eviction(session, id);
  session.query(
      "INSERT INTO evicted_distribution (digest, revision, evicted_ms) VALUES ($1, $2, $3)", id,
      revisions.newest, now_ms());
  remove_row(session, *revisions.row);
  return true;
}

bool evict_audited(Session& session, const Digest& id, const AuditEntry* audit) {
  std::string before;
  if (audit != nullptr)
    if (const std::optional<Distribution> known = select_distribution(session, id).distribution)
      before = describe_distribution(*known);
  const bool was_there = delete_distribution(session, id);
  if (was_there)
    note_act(session, audit, AuditOutcome::Done, std::move(before), "gone");
  return was_there;
}

DistributionRead select_distribution(Session& session, const Digest& id) {
  DistributionRead read =
      read_where(session,
                 "(SELECT max(id) FROM distribution WHERE digest = $1 AND NOT " +
                     session.is_quarantined("distribution") + ")",
                 Parameter(id));
  if (read.distribution && read.distribution->id != id)
    return {std::nullopt, true};
  return read;
}

DistributionRead read_distribution(Session& session, std::int64_t row) {
  return read_where(session, "$1", Parameter(row));
}

}  // namespace kinship::store
