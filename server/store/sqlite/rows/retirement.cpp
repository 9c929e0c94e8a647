#include "server/store/sqlite/rows/retirement.hpp"

#include <map>
#include <string>
#include <vector>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/rows/attempt_rows.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"
#include "server/store/tables/audit.hpp"
#include "server/store/tables/pages.hpp"
#include "server/store/tables/searches.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store {
namespace {

/// Adds the query's rows, as far as they can be read. \return whether all of them were.
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
      "(SELECT id FROM quarantine WHERE of_table = 'path' AND replaced_by = ?3)) AND " +
      database.is_intact("attempt"));
  query->bind_all(key.task_id, key.robot_id, path_id);
  append_reports(*query, reports);
}

bool stands_for_others(Database& database, std::int64_t path_id) {
  const auto query = database.cached(
      "SELECT 1 FROM quarantine WHERE of_table = 'path' AND replaced_by = ? LIMIT 1");
  return query->bind(1, path_id).step();
}

// Paths that are not retired, also damaged ones.
constexpr std::string_view kNotRetired =
    " AND retired_ms IS NULL AND NOT EXISTS (SELECT 1 FROM quarantine WHERE of_table = 'path' AND"
    " quarantine.id = path.id AND quarantine.retired_ms IS NOT NULL) ";

/// \return whether it was not among them before.
bool note_retired_report(Database& database, const Uuid& report_uuid) {
  database.cached("INSERT OR IGNORE INTO retired_report (report_uuid, retired_ms) VALUES (?, ?)")
      ->bind_all(Bytes(report_uuid.bytes), now_ms())
      .run();
  return database.changed_rows() > 0;
}

/// Notes every report of this path: the one that brought it, and the ones of the same content.
void note_retired_path(Database& database, const ExperienceKey& key, std::int64_t path_id) {
  std::vector<Uuid> reports;
  {
    const auto others =
        database.cached("SELECT report_uuid FROM same_content WHERE path_id = ? AND " +
                        database.is_intact("same_content"));
    append_reports(others->bind(1, path_id), reports);
  }
  bool is_whole = false;
  {
    const auto own = database.cached("SELECT report_uuid FROM path WHERE id = ? AND " +
                                     database.is_intact("path"));
    const std::size_t others = reports.size();
    is_whole = append_reports(own->bind(1, path_id), reports) && reports.size() > others;
  }
  if (!is_whole || stands_for_others(database, path_id))
    append_from_attempts(database, key, path_id, reports);
  for (const Uuid& report : reports)
    note_retired_report(database, report);
}

/// A damaged path was in fits before it was found damaged: it is retired as any other, but was
/// taken out of the count already.
void retire(Batch& batch, const ExperienceKey& key, std::int64_t id) {
  Database& database = batch.database();
  note_retired_path(database, key, id);
  const bool quarantined = find_quarantined(database, "path", id).has_value();
  if (quarantined)
    retire_quarantined(database, id);
  else if (database.try_change("UPDATE path SET retired_ms = $1 WHERE id = $2", now_ms(), id))
    uncount_paths(database, key, 1);
  else
    retire_damaged(batch, key, id);
  batch.paths_retired(key.task_id, key.robot_id);
}

}  // namespace

bool is_report_retired(Database& database, const Uuid& report_uuid) {
  const auto query = database.cached("SELECT 1 FROM retired_report WHERE report_uuid = ? AND " +
                                     database.is_intact("retired_report"));
  return query->bind(1, Bytes(report_uuid.bytes)).step();
}

void note_same_content(Database& database, std::int64_t path_id, const Uuid& report_uuid) {
  database.cached("INSERT OR IGNORE INTO same_content (path_id, report_uuid) VALUES (?, ?)")
      ->bind_all(path_id, Bytes(report_uuid.bytes))
      .run();
}

Feed<Uuid> page_of_retirements(Database& database, std::string_view cursor, std::size_t limit) {
  return read_feed<Uuid>(
      database.query("SELECT id, report_uuid FROM retired_report WHERE id > $1 AND " +
                         database.is_intact("retired_report") + " ORDER BY id LIMIT $2",
                     parse_rising_cursor(cursor), limit + 1),
      cursor, limit, [](const Row& row) { return id_of<Uuid>(row.column_blob(1)); },
      [](const Row& row) { return std::to_string(row.column_integer(0)); });
}

Result<Retirement> retire_path(Batch& batch, const Uuid& report_uuid, const AuditEntry* audit) {
  Database& database = batch.database();
  const ReportRows report = find_report(database, report_uuid);
  if (!report.row && report.damaged.empty()) {
    database.require_absent("attempt", "report_uuid", Parameter(report_uuid));
    return no_such_report(report_uuid);
  }
  if (!report.row)
    return Error{ErrorCode::Storage, "path " + report_uuid.text() + ": its attempt is damaged"};
  AttemptRow attempt = select_attempt(database, *report.row);
  name_robot_and_task(database, attempt);
  if (!attempt.path_id)
    return report_without_path(report_uuid, attempt.attempt.record.outcome == Outcome::Solved);
  Retirement retired;
  retired.task = attempt.attempt.task;
  const std::int64_t before = audit == nullptr ? 0 : count_paths_of(database, retired.task);
  const ExperienceKey key{attempt.task_id, attempt.robot_id};
  const std::int64_t id = row_in_use(database, "path", *attempt.path_id).value_or(*attempt.path_id);
  const std::optional<QuarantinedRow> quarantined = find_quarantined(database, "path", id);
  if (!(quarantined && quarantined->retired) && !is_retired(database, key, id)) {
    retire(batch, key, id);
    retired.paths = 1;
    add_robot(retired, attempt.attempt.robot);
  }
  note_retired_report(database, report_uuid);
  drop_search_of(database, report_uuid);
  if (audit != nullptr)
    note_act(database, audit, AuditOutcome::Done, describe_paths(retired.task, before),
             in_number(count_paths_of(database, retired.task), "path"));
  return retired;
}

std::vector<Retirement> retire_reports(Batch& batch, std::span<const Uuid> reports) {
  std::map<std::string, Retirement> retired;  // by task
  for (const Uuid& report : reports) {
    if (!note_retired_report(batch.database(), report))
      continue;
    // A report that is unknown, has no path or cannot be read is remembered by its UUID alone.
    const Result<Retirement> one = retire_path(batch, report, nullptr);
    if (!one || one->paths == 0)
      continue;
    Retirement& of_task = retired[one->task];
    of_task.task = one->task;
    of_task.paths += one->paths;
    for (const Digest& robot : one->robots)
      add_robot(of_task, robot);
  }
  std::vector<Retirement> by_task;
  for (auto& [task, retirement] : retired)
    by_task.push_back(std::move(retirement));
  return by_task;
}

RetireSome retirement_in(Batch& batch) {
  return [&batch](const ExperienceKey& key, std::int64_t limit, std::int64_t last_id) {
    std::vector<std::int64_t> paths;  // from an index
    for (const Row& row : batch.database().query(
             "SELECT id FROM path INDEXED BY path_by_task_robot WHERE task_id = $1"
             " AND robot_id = $2 AND id <= $3" +
                 std::string(kNotRetired) + "LIMIT $4",
             key.task_id, key.robot_id, last_id, limit))
      paths.push_back(row.column_integer(0));
    for (const std::int64_t path : paths)
      retire(batch, key, path);
    return std::ssize(paths);
  };
}

}  // namespace kinship::store
