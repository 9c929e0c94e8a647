#include "server/store/tables/searches.hpp"

#include <algorithm>
#include <vector>

#include "server/store/values/columns.hpp"
#include "server/store/values/crc32c.hpp"
#include "server/store/values/search_blob.hpp"

namespace kinship::store {
namespace {

constexpr std::int64_t kMillisecondsOfADay = std::int64_t{24} * 3600 * 1000;
constexpr std::int64_t kTrimmedAtOnce = 500;

/// A row, as far as its age and size go.
struct OldSearch {
  std::int64_t id = 0, received_ms = 0;
  std::uint64_t bytes = 0;
};

std::vector<OldSearch> oldest_searches(Session& session) {
  std::vector<OldSearch> rows;
  for (const Row& row : session.query(
           "SELECT id, received_ms, bytes FROM search ORDER BY id LIMIT $1", kTrimmedAtOnce))
    rows.push_back({row.column_integer(0), row.column_integer(1), count_of(row, 2)});
  return rows;
}

/// The newest row of a report that is as it was written; `take` gets its payload.
template <typename Take>
bool with_sound_row(Session& session, const std::string& condition, const Parameter& value,
                    Take take) {
  return session.unless_damaged([&] {
    const Parameter values[] = {value};
    const Rows rows =
        session.query_with("SELECT crc32c, payload FROM search WHERE " + condition + " AND " +
                               session.is_intact("search") + " ORDER BY id DESC LIMIT 1",
                           values);
    if (rows.empty())
      return false;
    const Bytes payload = rows.front().column_blob(1);
    if (crc32c(payload) != rows.front().column_integer(0))
      return false;
    take(payload);
    return true;
  });
}

}  // namespace

void insert_search(Session& session, const PreparedAttempt& prepared, const ExperienceKey& key,
                   std::int64_t received_ms) {
  if (!prepared.search)
    return;
  const PreparedSearch& search = *prepared.search;
  session.query(
      "INSERT INTO search (report_uuid, task_id, robot_id, received_ms, bytes, why, crc32c,"
      " payload) VALUES ($1, $2, $3, $4, $5, $6, $7, $8)",
      prepared.attempt.report_uuid, key.task_id, key.robot_id,
      prepared.received_ms.value_or(received_ms), search.bytes(), search.why,
      crc32c(search.payload), search.payload);
}

std::optional<SearchRecord> select_search(Session& session, const Uuid& report_uuid) {
  std::optional<SearchRecord> search;
  with_sound_row(session, "report_uuid = $1", Parameter(report_uuid),
                 [&](Bytes payload) { search = decode_search(payload); });
  return search;
}

std::optional<std::string> select_why(Session& session, const Uuid& report_uuid) {
  return session.unless_damaged([&]() -> std::optional<std::string> {
    const Rows rows = session.query("SELECT why FROM search WHERE report_uuid = $1 AND " +
                                        session.is_intact("search") + " ORDER BY id DESC LIMIT 1",
                                    report_uuid);
    if (rows.empty())
      return std::nullopt;
    return std::string(rows.front().column_text(0));
  });
}

std::uint64_t count_search_bytes(Session& session) {
  const auto bytes = session.unless_damaged([&] {
    return session.find_integer("SELECT CAST(coalesce(sum(bytes), 0) AS bigint) FROM search");
  });
  return static_cast<std::uint64_t>(bytes.value_or(0));
}

bool trim_searches(Session& session, const SearchLimits& limits, std::int64_t now_ms) {
  std::uint64_t bytes = count_search_bytes(session);
  const std::int64_t since_ms =
      limits.days == 0 ? 0 : now_ms - static_cast<std::int64_t>(limits.days) * kMillisecondsOfADay;
  const std::vector<OldSearch> oldest =
      session.unless_damaged([&] { return oldest_searches(session); });
  std::int64_t gone = 0;
  for (const OldSearch& row : oldest) {
    if (row.received_ms >= since_ms && bytes <= limits.bytes)
      break;
    drop_search(session, row.id);
    bytes -= std::min(bytes, row.bytes);
    ++gone;
  }
  return gone == kTrimmedAtOnce;
}

void drop_search_of(Session& session, const Uuid& report_uuid) {
  static_cast<void>(session.try_change("DELETE FROM search WHERE report_uuid = $1", report_uuid));
}

void drop_searches_of(Session& session, const ExperienceKey& key) {
  static_cast<void>(session.try_change("DELETE FROM search WHERE robot_id = $1 AND task_id = $2",
                                       key.robot_id, key.task_id));
}

bool is_search_sound(Session& session, std::int64_t row) {
  return with_sound_row(session, "id = $1", Parameter(row), [](Bytes) {});
}

void drop_search(Session& session, std::int64_t row) {
  static_cast<void>(session.try_change("DELETE FROM search WHERE id = $1", row));
}

}  // namespace kinship::store
