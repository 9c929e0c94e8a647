#include "server/store/moving/side.hpp"

#include "server/store/tables/audit.hpp"
#include "server/store/tables/settings.hpp"

namespace kinship::store::moving {

std::vector<MovedRow> Side::all(const MovedTable& table) {
  const Selection selected = selection_of(table);
  return named([&] {
    std::vector<MovedRow> rows;
    for (const Row& row : session().query("SELECT " + selected.columns + " FROM " + selected.from +
                                          " WHERE " + selected.condition))
      rows.push_back(read_row(row, table));
    return rows;
  });
}

MovedRow Side::experience_of(const Pair& pair) {
  const MovedTable& table = moved_table("experience");
  return named([&] {
    const Rows rows = session().query("SELECT " + selection_of(table).columns +
                                          " FROM experience WHERE task_id = $1 AND robot_id = $2",
                                      pair.task_id, pair.robot_id);
    return rows.empty() ? MovedRow() : read_row(rows.front(), table);
  });
}

std::vector<RowFingerprint> Side::light(const MovedTable& table, const Pair& pair) {
  std::vector<Parameter> parameters;
  if (table.reading == Reading::ByPair)
    parameters = {Parameter(pair.task_id), Parameter(pair.robot_id)};
  return named([&] {
    std::vector<RowFingerprint> rows;
    for (const Row& row : session().query_with(selection_of(table).light, parameters)) {
      RowFingerprint& light = rows.emplace_back();
      for (int column = 0; column < row.columns(); ++column)
        light.at(static_cast<std::size_t>(column)) = row.column_integer(column);
    }
    return rows;
  });
}

std::string Side::setting(std::string_view key) {
  return named([&] { return read_setting(session(), key); });
}

void Side::put_setting(std::string_view key, const std::optional<std::string>& value) {
  named([&] { write_setting(session(), key, value); });
}

bool Side::has_content() {
  return named([&] {
    return session().find_integer(
               "SELECT EXISTS (SELECT 1 FROM robot) OR EXISTS (SELECT 1 FROM attempt) OR"
               " EXISTS (SELECT 1 FROM audit) OR EXISTS (SELECT 1 FROM retired_report)") != 0;
  });
}

void Side::add_audit(const AuditEntry& entry) {
  named([&] { insert_audit(session(), entry); });
}

}  // namespace kinship::store::moving
