#include "server/store/sqlite/rows/quarantine_rows.hpp"

#include <algorithm>
#include <array>

#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store {
namespace {

constexpr std::array<std::string_view, 4> kWithQuarantine = {"path", "attempt", "scene",
                                                             "distribution"};

}  // namespace

bool has_quarantine(std::string_view table) {
  return std::ranges::find(kWithQuarantine, table) != kWithQuarantine.end();
}

std::optional<QuarantinedRow> find_quarantined(Database& database, std::string_view table,
                                               std::int64_t id) {
  const auto query = database.cached(
      "SELECT replaced_by, retired_ms IS NOT NULL FROM quarantine"
      " WHERE of_table = ? AND id = ? AND " +
      database.is_intact("quarantine"));
  if (!query->bind_all(table, id).step())
    return std::nullopt;
  QuarantinedRow row;
  if (!query->column_is_null(0))
    row.replaced_by = query->column_integer(0);
  row.retired = query->column_integer(1) != 0;
  return row;
}

std::optional<std::int64_t> row_in_use(Database& database, std::string_view table,
                                       std::int64_t id) {
  // A row is replaced by one that came later, so the ids grow and this ends.
  for (std::optional<std::int64_t> row = id; row;) {
    const std::optional<QuarantinedRow> quarantined = find_quarantined(database, table, *row);
    if (!quarantined)
      return row;
    if (quarantined->replaced_by && *quarantined->replaced_by <= *row)
      break;
    row = quarantined->replaced_by;
  }
  return std::nullopt;
}

void quarantine_row(Database& database, std::string_view table, std::int64_t id,
                    std::optional<std::int64_t> replaced_by) {
  database
      .cached(
          "INSERT INTO quarantine (of_table, id, noticed_ms, replaced_by) VALUES (?, ?, ?, ?)"
          " ON CONFLICT (of_table, id) DO UPDATE"
          " SET replaced_by = coalesce(excluded.replaced_by, replaced_by)")
      ->bind_all(table, id, now_ms(), replaced_by)
      .run();
}

void retire_quarantined(Database& database, std::int64_t path_id) {
  database.cached("UPDATE quarantine SET retired_ms = ? WHERE of_table = 'path' AND id = ?")
      ->bind_all(now_ms(), path_id)
      .run();
}

void note_lost_attempts(Database& database) {
  database.execute(
      "INSERT OR IGNORE INTO lost_attempt (id) SELECT id FROM path WHERE NOT " +
      in_quarantine("path") +
      " AND NOT EXISTS (SELECT 1 FROM attempt WHERE attempt.report_uuid = path.report_uuid"
      " AND attempt.path_id = path.id)");
}

bool has_lost_attempts(Database& database) {
  return database.cached("SELECT 1 FROM lost_attempt LIMIT 1")->step();
}

std::vector<QuarantineCount> count_quarantined(Database& database) {
  const auto query = database.cached(
      "SELECT of_table, count(*) FROM quarantine WHERE replaced_by IS NULL GROUP BY of_table");
  std::vector<QuarantineCount> counts;
  while (query->step())
    counts.push_back({std::string(query->column_text(0)), count_of(*query, 1)});
  return counts;
}

}  // namespace kinship::store
