#include "server/store/sqlite/upkeep/repair_account.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store {
namespace {

/// A table whose rows are copied by their ids, and a query that an index alone answers.
struct AccountedTable {
  std::string_view name;
  std::size_t part;  ///< of the rows: one index that can be read to its end has all of a part
  std::string_view of_index;
};
constexpr std::size_t kParts = 2;
constexpr AccountedTable kAccounted[] = {
    {"robot", 0, "SELECT id FROM robot ORDER BY digest"},
    {"robot", 0, "SELECT id FROM robot ORDER BY label"},
    {"task", 0, "SELECT id FROM task ORDER BY name"},
    {"scene", 0, "SELECT id FROM scene INDEXED BY scene_by_content"},
    {"path", 0, "SELECT id FROM path INDEXED BY path_by_task_robot WHERE retired_ms IS NULL"},
    {"path", 0, "SELECT id FROM path INDEXED BY path_by_content WHERE retired_ms IS NULL"},
    {"path", 1, "SELECT id FROM path INDEXED BY path_retired WHERE retired_ms IS NOT NULL"},
    {"attempt", 0, "SELECT id, report_uuid FROM attempt INDEXED BY attempt_by_uuid"},
    {"attempt", 0, "SELECT id FROM attempt INDEXED BY attempt_by_task_robot"},
    {"audit", 0, "SELECT id FROM audit INDEXED BY audit_by_name"},
};

/// \return whether it could be read to its end.
template <typename Take>
bool read_rows(Database& source, const std::string& sql, Take take) try {
  Statement rows(source.connection(), sql);
  while (rows.step())
    take(rows);
  return true;
} catch (const SqliteError& error) {
  constexpr int kNoSuchObject = 1;  // SQLITE_ERROR
  if (!error.is_damage() && error.sqlite_code() != kNoSuchObject)
    throw;
  return false;
}

class Account {
 public:
  Account(Database& source, Database& target, std::string table)
      : source_(&source), target_(&target), table_{.name = std::move(table)} {}

  Repaired::Table take() {
    read_rows(*target_, "SELECT id FROM " + table_.name,
              [&](const Statement& row) { kept_.insert(row.column_integer(0)); });
    std::set<std::int64_t> found = kept_;
    const auto note = [&](const Statement& row) {
      found.insert(row.column_integer(0));
      if (row.columns() > 1)
        reports_[row.column_integer(0)] = id_of<Uuid>(row.column_blob(1));
    };
    std::array<bool, kParts> is_part_whole{};
    std::size_t parts = 0;
    for (const AccountedTable& each : kAccounted) {
      if (each.name != table_.name)
        continue;
      parts = std::max(parts, each.part + 1);
      is_part_whole[each.part] |= read_rows(*source_, std::string(each.of_index), note);
    }
    bool is_whole = std::all_of(is_part_whole.begin(),
                                is_part_whole.begin() + static_cast<std::ptrdiff_t>(parts),
                                [](bool each) { return each; });
    if (!is_whole)  // rows whose ids may be damaged, too
      is_whole =
          read_rows(*source_, "SELECT id FROM " + table_.name + " NOT INDEXED ORDER BY id", note);
    table_.is_before_known = is_whole;
    table_.before = found.size();
    table_.after = kept_.size();
    for (const std::int64_t id : found)
      if (!kept_.contains(id))
        miss(id);
    return std::move(table_);
  }

 private:
  /// Unless its content came again, under another id.
  void miss(std::int64_t id) {
    const auto report = reports_.find(id);
    bool is_there_again = false;
    if (report != reports_.end())
      is_there_again = target_->cached("SELECT 1 FROM attempt WHERE report_uuid = ?")
                           ->bind(1, Bytes(report->second.bytes))
                           .step();
    read_rows(*source_,
              "SELECT 1 FROM quarantine WHERE of_table = '" + table_.name +
                  "' AND id = " + std::to_string(id) + " AND replaced_by IS NOT NULL",
              [&](const Statement&) { is_there_again = true; });
    if (is_there_again)
      ++table_.again;
    else
      table_.missing.push_back(
          {id, report == reports_.end() ? std::nullopt : std::optional(report->second)});
  }

  Database* source_;
  Database* target_;
  Repaired::Table table_;
  std::set<std::int64_t> kept_;
  std::map<std::int64_t, Uuid> reports_;
};

}  // namespace

std::vector<Repaired::Table> account_of_rows(Database& source, Database& target) {
  std::vector<Repaired::Table> tables;
  for (const AccountedTable& each : kAccounted)
    if (tables.empty() || tables.back().name != each.name)
      tables.push_back(Account(source, target, std::string(each.name)).take());
  return tables;
}

}  // namespace kinship::store
