#include "server/store/sqlite/rows/audit_rows.hpp"

#include <optional>
#include <string>
#include <utility>

#include "server/store/sqlite/rows/distribution_rows.hpp"
#include "server/store/sqlite/rows/robot_removal.hpp"
#include "server/store/sqlite/rows/robot_rows.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store {
namespace {

void note(Database& database, const AuditEntry* audit, AuditOutcome outcome, std::string before,
          std::string after = {}) {
  if (audit != nullptr)
    insert_audit(database, entry_of_act(*audit, outcome, std::move(before), std::move(after)));
}

std::int64_t count_paths_of(Database& database, std::string_view task) {
  const auto query = database.cached(
      "SELECT coalesce(sum(paths), 0) FROM experience JOIN task ON task.id = experience.task_id "
      "WHERE task.name = ?");
  query->bind(1, task).step();
  return query->column_integer(0);
}

std::string paths_of(Database& database, std::string_view task) {
  return describe_paths(task, count_paths_of(database, task));
}

std::string name_of_task(Database& database, std::int64_t task_id) {
  const auto query = database.cached("SELECT name FROM task WHERE id = ?");
  return query->bind(1, task_id).step() ? std::string(query->column_text(0)) : std::string();
}

/// A robot as it is before it is removed.
std::string robot_of(Database& database, const Digest& robot) {
  const auto query = database.cached(
      "SELECT label, (SELECT coalesce(sum(paths), 0) FROM experience WHERE robot_id = robot.id),"
      " (SELECT coalesce(sum(attempts), 0) FROM experience WHERE robot_id = robot.id) "
      "FROM robot WHERE digest = ?");
  if (!query->bind(1, Bytes(robot.bytes)).step())
    return {};
  return describe_robot(query->column_text(0), robot, query->column_integer(1),
                        query->column_integer(2));
}

/// What a restore replaces need not be a store.
bool has_audit(Database& database) {
  return database.integer("SELECT count(*) FROM sqlite_master WHERE name = 'audit'") > 0;
}

}  // namespace

void insert_audit(Database& database, const AuditEntry& entry) {
  const AuditEntry written = cut_to_fit(entry);
  database
      .cached(
          "INSERT INTO audit (time_ms, name, role, client, is_local, verb, target, outcome, was,"
          " became, message) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      ->bind_all(now_ms(), std::string_view(written.name), std::string_view(written.role),
                 std::string_view(written.client), std::int64_t{written.is_local},
                 std::string_view(written.verb), std::string_view(written.target),
                 static_cast<std::int64_t>(written.outcome) + 1, std::string_view(written.before),
                 std::string_view(written.after), std::string_view(written.message))
      .run();
}

void note_maintenance(Database& database, const std::string& verb,
                      const std::filesystem::path& target, const std::string& before,
                      const std::string& after) {
  insert_audit(database, entry_of_maintenance(verb, target.string(), before, after));
}

void copy_missing_audit(Database& database, Database& other) {
  if (!has_audit(other))
    return;
  const std::string columns =
      "time_ms, name, role, client, is_local, verb, target, outcome, was, became, message";
  constexpr int kColumns = 11;
  const auto insert =
      database.cached("INSERT INTO audit (" + columns +
                      ") SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11 "
                      "WHERE NOT EXISTS (SELECT 1 FROM audit WHERE id = ?12 AND (" +
                      columns + ") = (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11))");
  Statement rows(other.connection(), "SELECT " + columns + ", id FROM audit ORDER BY id");
  while (rows.step()) {
    for (int column = 0; column <= kColumns; ++column)
      insert->bind_column(column + 1, rows, column);
    insert->run();
    insert->reset();
  }
}

Result<bool> rename_audited(Database& database, const Digest& robot, const std::string& label,
                            const AuditEntry* audit) {
  const std::optional<RobotRecord> before =
      audit == nullptr ? std::nullopt : select_robot(database, robot);
  Result<bool> renamed = relabel_robot(database, robot, label);
  if (renamed && before)
    note(database, audit, AuditOutcome::Done, "'" + before->description.label + "'",
         "'" + label + "' (" + robot.short_hex() + ")");
  return renamed;
}

Result<bool> remove_audited(Batch& batch, const Digest& robot, RemovedRobot& removed,
                            const AuditEntry* audit) {
  Database& database = batch.database();
  const bool is_first = removed.removal.paths == 0;
  std::string before = audit == nullptr ? std::string() : robot_of(database, robot);
  Result<bool> is_out = continue_removal(batch, robot, removed);
  if (!is_out)
    return is_out;
  if (*is_out)
    note(database, audit, AuditOutcome::Done, std::move(before), describe_removal(removed.removal));
  else if (is_first)
    note(database, audit, AuditOutcome::Begun, std::move(before));
  return is_out;
}

Result<Retirement> retire_audited(Batch& batch, const Uuid& report_uuid, const AuditEntry* audit) {
  Database& database = batch.database();
  Result<Retirement> retired = retire_path(batch, report_uuid);
  if (!retired || audit == nullptr)
    return retired;
  const std::int64_t left = count_paths_of(database, retired->task);
  const auto gone = static_cast<std::int64_t>(retired->paths);
  note(database, audit, AuditOutcome::Done, describe_paths(retired->task, left + gone),
       in_number(left, "path"));
  return retired;
}

Result<TaskReset> begin_reset_audited(Database& database, std::string_view task,
                                      const AuditEntry* audit) {
  Result<TaskReset> reset = begin_reset(database, task);
  if (reset && audit != nullptr)
    note(database, audit, AuditOutcome::Begun, paths_of(database, task));
  return reset;
}

bool continue_reset_audited(Batch& batch, const TaskReset& reset, Retirement& retired,
                            const AuditEntry* audit) {
  const bool goes_on = continue_reset(batch, reset, retired);
  if (goes_on || audit == nullptr)
    return goes_on;
  Database& database = batch.database();
  note(database, audit, AuditOutcome::Done, {},
       paths_of(database, name_of_task(database, reset.task_id)) + ", " +
           std::to_string(retired.paths) + " retired");
  return false;
}

bool evict_audited(Database& database, const Digest& id, const AuditEntry* audit) {
  std::string before;
  if (audit != nullptr)
    if (const std::optional<Distribution> known = select_distribution(database, id).distribution)
      before = describe_distribution(*known);
  const bool was_there = delete_distribution(database, id);
  if (was_there)
    note(database, audit, AuditOutcome::Done, std::move(before), "gone");
  return was_there;
}

}  // namespace kinship::store
