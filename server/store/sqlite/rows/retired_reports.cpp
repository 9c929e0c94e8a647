#include "server/store/sqlite/rows/retired_reports.hpp"

#include <string>
#include <vector>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/tables/read_page.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/pages.hpp"

namespace kinship::store {
namespace {

/// What the query finds is added, as far as it can be read. \return whether all of it was.
bool append_reports(Statement& query, std::vector<Uuid>& reports) {
  try {
    while (query.step())
      reports.push_back(id_of<Uuid>(query.column_blob(0)));
    return true;
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    return false;
  }
}

/// From the attempts of its robot and task, one by one: for a path whose row cannot be read, or
/// stands for another one.
void append_from_attempts(Database& database, const ExperienceKey& key, std::int64_t path_id,
                          std::vector<Uuid>& reports) {
  const auto query = database.cached(
      "SELECT report_uuid FROM attempt INDEXED BY attempt_by_task_robot "
      "WHERE task_id = ?1 AND robot_id = ?2 AND (path_id = ?3 OR path_id IN "
      "(SELECT id FROM set_aside WHERE kind = 1 AND replaced_by = ?3))");
  query->bind_all(key.task_id, key.robot_id, path_id);
  append_reports(*query, reports);
}

bool stands_for_others(Database& database, std::int64_t path_id) {
  const auto query =
      database.cached("SELECT 1 FROM set_aside WHERE kind = 1 AND replaced_by = ? LIMIT 1");
  return query->bind(1, path_id).step();
}

}  // namespace

bool is_report_retired(Database& database, const Uuid& report_uuid) {
  const auto query = database.cached("SELECT 1 FROM retired_report WHERE report_uuid = ?");
  return query->bind(1, Bytes(report_uuid.bytes)).step();
}

bool note_retired_report(Database& database, const Uuid& report_uuid) {
  database.cached("INSERT OR IGNORE INTO retired_report (report_uuid, retired_ms) VALUES (?, ?)")
      ->bind_all(Bytes(report_uuid.bytes), now_ms())
      .run();
  return database.changed_rows() > 0;
}

void note_retired_path(Database& database, const ExperienceKey& key, std::int64_t path_id) {
  std::vector<Uuid> reports;
  {
    const auto others = database.cached("SELECT report_uuid FROM same_content WHERE path_id = ?");
    append_reports(others->bind(1, path_id), reports);
  }
  bool is_whole = false;
  {
    const auto own = database.cached("SELECT report_uuid FROM path WHERE id = ?");
    is_whole = append_reports(own->bind(1, path_id), reports);
  }
  if (!is_whole || stands_for_others(database, path_id))
    append_from_attempts(database, key, path_id, reports);
  for (const Uuid& report : reports)
    note_retired_report(database, report);
}

void note_same_content(Database& database, std::int64_t path_id, const Uuid& report_uuid) {
  database.cached("INSERT OR IGNORE INTO same_content (path_id, report_uuid) VALUES (?, ?)")
      ->bind_all(path_id, Bytes(report_uuid.bytes))
      .run();
}

Feed<Uuid> page_of_retirements(Database& database, std::string_view cursor, std::size_t limit) {
  return read_feed<Uuid>(
      database.query(
          "SELECT id, report_uuid FROM retired_report WHERE id > $1 ORDER BY id LIMIT $2",
          parse_rising_cursor(cursor), limit + 1),
      cursor, limit, [](const Row& row) { return id_of<Uuid>(row.column_blob(1)); },
      [](const Row& row) { return std::to_string(row.column_integer(0)); });
}

}  // namespace kinship::store
