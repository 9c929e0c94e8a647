#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/sqlite/database/database.hpp"

/// The quarantine: ids of damaged rows of the tables path, attempt, scene and distribution. It is a
/// table of its own, because a damaged row may be neither readable nor writable.
namespace kinship::store {

/// Whether damaged rows of a table are quarantined.
bool has_quarantine(std::string_view table);

/// A quarantined row.
struct QuarantinedRow {
  std::optional<std::int64_t> replaced_by;  ///< brought by a later report
  bool retired = false;                     ///< a path
};

/// Nothing if the row is in use.
std::optional<QuarantinedRow> find_quarantined(Database& database, std::string_view table,
                                               std::int64_t id);

/// The row to use for this one: itself, its replacement, or nothing while it is quarantined.
std::optional<std::int64_t> row_in_use(Database& database, std::string_view table, std::int64_t id);

/// Quarantines a row, or notes the replacement of a quarantined one.
void quarantine_row(Database& database, std::string_view table, std::int64_t id,
                    std::optional<std::int64_t> replaced_by = std::nullopt);

/// Retires a quarantined path.
void retire_quarantined(Database& database, std::int64_t path_id);

/// Notes the paths, in use or retired, whose attempts are lost.
void note_lost_attempts(Database& database);
bool has_lost_attempts(Database& database);

/// Quarantined rows of a table that were not replaced.
struct QuarantineCount {
  std::string table;
  std::uint64_t rows = 0;
};
std::vector<QuarantineCount> count_quarantined(Database& database);

}  // namespace kinship::store
