#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "server/store/rules/batch_changes.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// \return the id of the new row.
std::int64_t insert_attempt(Database& database, const NewAttempt& added,
                            std::optional<std::int64_t> scene_id, std::int64_t now_ms);

/// The rows of one report, from the index.
struct ReportRows {
  std::optional<std::int64_t> row;    ///< not quarantined; it may turn out to be damaged
  std::vector<std::int64_t> damaged;  ///< quarantined and not replaced yet
};
ReportRows find_report(Database& database, const Uuid& report_uuid);

/// An attempt without its path and scene, and their ids.
struct AttemptRow {
  Attempt attempt;
  std::int64_t task_id = 0;
  std::int64_t robot_id = 0;
  std::optional<std::int64_t> path_id;
  std::optional<std::int64_t> scene_id;
  std::int64_t received_ms = 0;
  bool is_robot_removed = false;
};
/// Without the names of its robot and task, which are in other tables. \throws SqliteError: if
/// is_damage(), the row is damaged.
AttemptRow select_attempt(Database& database, std::int64_t id);
/// With the names. Nothing if there is none, or it cannot be read.
/// \param damaged  takes the id of a row that is not as it was written.
std::optional<AttemptRow> select_named(Database& database, std::optional<std::int64_t> id,
                                       std::vector<std::int64_t>& damaged);
void name_robot_and_task(Database& database, AttemptRow& row);

}  // namespace kinship::store
