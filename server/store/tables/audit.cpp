#include "server/store/tables/audit.hpp"

#include <utility>
#include <vector>

#include "server/store/tables/pages.hpp"
#include "server/store/values/audit_texts.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store {

void insert_audit(Session& session, const AuditEntry& entry) {
  const AuditEntry written = cut_to_fit(entry);
  session.query(
      "INSERT INTO audit (time_ms, name, role, client, is_local, verb, target, outcome, was,"
      " became, message) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)",
      now_ms(), written.name, written.role, written.client, written.is_local, written.verb,
      written.target, static_cast<std::int64_t>(written.outcome) + 1, written.before, written.after,
      written.message);
}

void note_act(Session& session, const AuditEntry* audit, AuditOutcome outcome, std::string before,
              std::string after) {
  if (audit != nullptr)
    insert_audit(session, entry_of_act(*audit, outcome, std::move(before), std::move(after)));
}

std::int64_t count_paths_of(Session& session, std::string_view task) {
  return *session.find_integer(
      "SELECT CAST(coalesce(sum(paths), 0) AS bigint) FROM experience"
      " WHERE task_id = (SELECT id FROM task WHERE name = $1)",
      task);
}

std::string describe_robot(Session& session, const Digest& robot) {
  const Rows rows = session.query(
      "SELECT label,"
      " (SELECT CAST(coalesce(sum(paths), 0) AS bigint) FROM experience"
      "  WHERE robot_id = robot.id),"
      " (SELECT CAST(coalesce(sum(attempts), 0) AS bigint) FROM experience"
      "  WHERE robot_id = robot.id) FROM robot WHERE digest = $1",
      robot);
  if (rows.empty())
    return {};
  const Row& row = rows.front();
  return describe_robot(row.column_text(0), robot, row.column_integer(1), row.column_integer(2));
}

Page<AuditEntry> page_of_audit(Session& session, std::string_view name, std::string_view cursor,
                               std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  std::vector<Parameter> parameters = {Parameter(parse_falling_cursor(cursor)),
                                       Parameter(rows + 1)};
  if (!name.empty())
    parameters.emplace_back(name);
  return read_page<AuditEntry>(
      session.query_with("SELECT " + std::string(kAuditColumns) + "FROM audit WHERE id < $1 AND " +
                             session.is_intact("audit") + (name.empty() ? "" : " AND name = $3") +
                             " ORDER BY id DESC LIMIT $2",
                         parameters),
      rows, read_audit_entry<Row>,
      [](const Row& row) { return std::to_string(row.column_integer(0)); });
}

}  // namespace kinship::store
