#include "server/store/moving/moved_tables.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include "server/store/rules/batch_changes.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/values/record_columns.hpp"

namespace kinship::store::moving {
namespace {

using enum CellType;

/// SQL for a column of SQLite's quarantine; NULL: the row is not in it.
std::string quarantined(const std::string& column, const std::string& table) {
  return "(SELECT " + column + " FROM quarantine WHERE of_table = '" + table +
         "' AND quarantine.id = " + table + ".id)";
}

MovedColumn damaged_ms(const std::string& table) {
  return {"damaged_ms", Integer, quarantined("noticed_ms", table), true};
}

MovedTable robots() {
  return {.name = "robot",
          .columns = {{"id"},
                      {"digest", Blob},
                      {"label", Text},
                      {"dof"},
                      {"base_link", Text},
                      {"tip_link", Text},
                      {"T_tip_transfer", Blob},
                      {"task_axes"},
                      {"registered_ms"},
                      {"crc32c"},
                      {"urdf", Text}}};
}

MovedTable experience() {
  MovedTable table{.name = "experience",
                   .keys = 2,
                   .columns = {{"task_id"}, {"robot_id"}, {"generation"}, {"retired_generation"}}};
  for_each_sum({}, [&]<typename T>(std::string_view mode, std::string_view column, T /*change*/) {
    table.columns.push_back(
        {std::string(mode).append(column), std::is_same_v<T, double> ? Real : Integer});
  });
  return table;
}

/// One that was replaced in SQLite has its first id and the content of the last (SqliteScenes): in
/// PostgreSQL a content has one row, which is mended.
MovedTable scenes() {
  const std::string in_use = quarantined("replaced_by", "scene") + " IS NULL";
  return {.name = "scene",
          .reading = Reading::ById,
          .columns = {{"id"},
                      {"content_sha256", Blob},
                      {"received_ms"},
                      {"size"},
                      {"encoding"},
                      {"crc32c"},
                      damaged_ms("scene"),
                      {"scene", Blob}},
          .sqlite_light = "SELECT id, coalesce(" + quarantined("noticed_ms", "scene") +
                          ", 0) FROM scene WHERE " + in_use + " ORDER BY id",
          .postgres_light = "SELECT id, coalesce(damaged_ms, 0) FROM scene ORDER BY id",
          .has_quarantine = true};
}

MovedTable paths() {
  // Whether one is retired stands behind the waypoints: the indexes know it without a look there.
  const auto indexed = [](const std::string& index, const std::string& retired,
                          const std::string& condition) {
    return "SELECT path.id, " + retired +
           ", coalesce(quarantine.noticed_ms, 0), coalesce(quarantine.replaced_by, 0)"
           " FROM path INDEXED BY " +
           index +
           " LEFT JOIN quarantine ON of_table = 'path' AND quarantine.id = path.id"
           " WHERE path.task_id = ?1 AND path.robot_id = ?2 AND path.retired_ms IS " +
           condition;
  };
  return {
      .name = "path",
      .reading = Reading::ByPair,
      .columns = {{"id"},
                  {"task_id"},
                  {"robot_id"},
                  {"report_uuid", Blob},
                  {"content_sha256", Blob},
                  {"waypoint_count"},
                  {"dof"},
                  {"length", Real},
                  {"received_ms"},
                  {"retired_ms", Integer,
                   "coalesce(path.retired_ms, " + quarantined("retired_ms", "path") + ")"},
                  damaged_ms("path"),
                  {"replaced_by", Integer, quarantined("replaced_by", "path"), true},
                  {"scene_id"},
                  {"T_task_base", Blob},
                  {"encoding"},
                  {"crc32c"},
                  {"waypoints", Blob}},
      .sqlite_light = indexed("path_by_task_robot", "quarantine.retired_ms IS NOT NULL", "NULL") +
                      " UNION ALL " + indexed("path_retired", "1", "NOT NULL") + " ORDER BY 1",
      .postgres_light =
          "SELECT id, (retired_ms IS NOT NULL)::int::bigint, coalesce(damaged_ms, 0),"
          " coalesce(replaced_by, 0) FROM path"
          " WHERE task_id = $1 AND robot_id = $2 ORDER BY id",
      .has_quarantine = true};
}

std::vector<MovedColumn> columns_of_attempt() {
  std::vector<MovedColumn> columns = {
      {"id"},      {"task_id"}, {"robot_id"},      {"report_uuid", Blob}, {"body_sha256", Blob},
      {"path_id"}, {"status"},  {"machine", Text}, {"T_task_base", Blob}, {"received_ms"},
      {"scene_id"}};
  for_each_field<PlanningRecord>([&]<typename Of, typename T>(const Field<Of, T>& field) {
    using Value = ColumnValue<T>;
    constexpr CellType kType = std::is_same_v<Value, std::int64_t>       ? Integer
                               : std::is_same_v<Value, double>           ? Real
                               : std::is_same_v<Value, std::string_view> ? Text
                                                                         : Blob;
    columns.push_back({std::string(column_of(field.name)), kType});
  });
  return columns;
}

/// One that is quarantined in SQLite stands for nothing: its UUID may come again, as if it were
/// new.
MovedTable attempts() {
  const std::string readable = "NOT " + in_quarantine("attempt");
  return {.name = "attempt",
          .reading = Reading::ByPair,
          .columns = columns_of_attempt(),
          .sqlite_condition = readable,
          .sqlite_light =
              "SELECT id, status, coalesce(path_id, 0) FROM attempt"
              " WHERE task_id = ?1 AND robot_id = ?2 AND " +
              readable + " ORDER BY id",
          .postgres_light =
              "SELECT id, status, coalesce(path_id, 0) FROM attempt"
              " WHERE task_id = $1 AND robot_id = $2 ORDER BY id",
          .is_in_arrival = true};
}

MovedTable distributions() {
  const std::string sound = "NOT " + in_quarantine("distribution");
  return {.name = "distribution",
          .reading = Reading::ById,
          .columns = {{"id"},
                      {"digest", Blob},
                      {"revision"},
                      {"task_id"},
                      {"robot_id"},
                      {"profile", Text},
                      {"state"},
                      {"reason", Text},
                      {"components"},
                      {"configurations"},
                      {"paths"},
                      {"fitted_ms"},
                      {"crc32c"},
                      {"payload", Blob}},
          .sqlite_condition = sound,
          .sqlite_light =
              "SELECT id, revision, crc32c FROM distribution WHERE " + sound + " ORDER BY id",
          .postgres_light = "SELECT id, revision, crc32c FROM distribution ORDER BY id"};
}

MovedTable uses() {
  return {.name = "distribution_use",
          .columns = {{"id"}, {"used_ms"}, {"bytes"}},
          .sqlite_condition = "id IN (SELECT id FROM distribution WHERE NOT " +
                              in_quarantine("distribution") + ")"};
}

/// With the quarantined rows of SQLite: no revision is given twice.
MovedTable evictions() {
  return {
      .name = "evicted_distribution",
      .columns = {{"digest", Blob}, {"revision"}, {"evicted_ms"}},
      .sqlite_from =
          "(SELECT digest, max(revision) AS revision, max(evicted_ms) AS evicted_ms FROM"
          " (SELECT digest, revision, evicted_ms FROM evicted_distribution UNION ALL"
          " SELECT digest, revision, noticed_ms FROM distribution JOIN quarantine"
          " ON of_table = 'distribution' AND quarantine.id = distribution.id) GROUP BY digest)"};
}

MovedTable rehearsals() {
  const std::string light = "SELECT id, made_ms, crc32c FROM rehearsal ORDER BY id";
  return {.name = "rehearsal",
          .reading = Reading::ById,
          .columns = {{"id"},
                      {"digest", Blob},
                      {"robot", Blob},
                      {"task", Text},
                      {"made_ms"},
                      {"crc32c"},
                      {"payload", Blob}},
          .sqlite_light = light,
          .postgres_light = light};
}

MovedTable searches() {
  const std::string light = "SELECT id, received_ms, crc32c FROM search ORDER BY id";
  return {.name = "search",
          .reading = Reading::ById,
          .columns = {{"id"},
                      {"report_uuid", Blob},
                      {"task_id"},
                      {"robot_id"},
                      {"received_ms"},
                      {"bytes"},
                      {"why", Text},
                      {"crc32c"},
                      {"payload", Blob}},
          .sqlite_light = light,
          .postgres_light = light};
}

MovedTable meshes() {
  const std::string light = "SELECT id, bytes, crc32c FROM mesh ORDER BY id";
  return {.name = "mesh",
          .reading = Reading::ById,
          .columns = {{"id"}, {"digest", Blob}, {"bytes"}, {"crc32c"}, {"payload", Blob}},
          .sqlite_light = light,
          .postgres_light = light};
}

MovedTable audit() {
  return {.name = "audit",
          .reading = Reading::ById,
          .columns = {{"id"},
                      {"time_ms"},
                      {"name", Text},
                      {"role", Text},
                      {"client", Text},
                      {"is_local"},
                      {"verb", Text},
                      {"target", Text},
                      {"outcome"},
                      {"was", Text},
                      {"became", Text},
                      {"message", Text}},
          .sqlite_light = "SELECT id FROM audit ORDER BY id",
          .postgres_light = "SELECT id FROM audit ORDER BY id"};
}

/// Notes, and the floor of revisions; epochs, runs and keys belong to one store.
MovedTable settings() {
  const std::string moved = "key = 'revision_floor' OR key LIKE 'note:%'";
  return {.name = "setting",
          .columns = {{"key", Text}, {"value", Text}},
          .sqlite_condition = moved,
          .postgres_condition = moved};
}

std::vector<MovedTable> all_tables() {
  return {robots(),
          {.name = "robot_held_joint",
           .keys = 2,
           .columns = {{"robot_id"}, {"joint", Text}, {"position", Real}}},
          {.name = "robot_never_colliding",
           .keys = 2,
           .columns = {{"robot_id"}, {"ordinal"}, {"link_a", Text}, {"link_b", Text}}},
          {.name = "robot_geometry",
           .columns = {{"robot_id"}, {"revision"}, {"taken_ms"}, {"mesh_solids", Blob}}},
          {.name = "task", .columns = {{"id"}, {"name", Text}, {"removed_attempts"}}},
          experience(),
          scenes(),
          paths(),
          attempts(),
          distributions(),
          uses(),
          evictions(),
          rehearsals(),
          searches(),
          meshes(),
          audit(),
          settings(),
          {.name = "retired_report",
           .reading = Reading::ById,
           .columns = {{"id"}, {"report_uuid", Blob}, {"retired_ms"}},
           .sqlite_light = "SELECT id FROM retired_report ORDER BY id",
           .postgres_light = "SELECT id FROM retired_report ORDER BY id",
           .is_in_arrival = true}};
}

}  // namespace

std::size_t MovedTable::column(const std::string& wanted) const {
  const auto found = std::ranges::find(columns, wanted, &MovedColumn::name);
  if (found == columns.end())
    throw std::logic_error("table " + name + " has no column " + wanted);
  return static_cast<std::size_t>(found - columns.begin());
}

std::string listed(const MovedTable& table, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i)
    text += (i == 0 ? "" : ", ") + table.columns[i].name;
  return text;
}

std::span<const MovedTable> moved_tables() {
  static const std::vector<MovedTable> tables = all_tables();
  return tables;
}

const MovedTable& moved_table(std::string_view name) {
  const std::span<const MovedTable> tables = moved_tables();
  const auto found = std::ranges::find(tables, name, &MovedTable::name);
  if (found == tables.end())
    throw std::logic_error("there is no table " + std::string(name));
  return *found;
}

}  // namespace kinship::store::moving
