#include "server/store/sqlite/database/row_checksums.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/statement.hpp"
#include "server/store/values/crc32c.hpp"

namespace kinship::store {
namespace {

constexpr std::string_view kChecksum = "row_crc32c";
constexpr std::array<std::string_view, 3> kLargeBlobs = {"waypoints", "scene", "payload"};
/// Part of the checksum of a robot's description. SQLite reads a text to tell its length.
constexpr std::array<std::string_view, 2> kLargeOfRobot = {"urdf", "mesh_solids"};
/// An UPDATE of their rows sets some columns and keeps the others.
constexpr std::array<std::string_view, 5> kUpdatedInPart = {"attempt", "experience", "path",
                                                            "quarantine", "task"};

template <typename Names>
bool contains(const Names& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

Bytes bytes_of(sqlite3_value* value) {
  const auto* const data = static_cast<const std::uint8_t*>(sqlite3_value_blob(value));
  return {data, static_cast<std::size_t>(sqlite3_value_bytes(value))};
}

std::uint32_t add_integer(std::uint64_t value, std::uint32_t crc) {
  std::array<std::uint8_t, sizeof(value)> bytes{};
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(value);
    value >>= 8U;
  }
  return crc32c(Bytes(bytes), crc);
}

/// With the type, and with the size of a text or blob: no two rows have the same bytes.
std::uint32_t add_value(sqlite3_value* value, std::uint32_t crc) {
  const auto type = static_cast<std::uint8_t>(sqlite3_value_type(value));
  crc = crc32c(Bytes(&type, 1), crc);
  switch (type) {
    case SQLITE_INTEGER:
      return add_integer(static_cast<std::uint64_t>(sqlite3_value_int64(value)), crc);
    case SQLITE_FLOAT:  // SQLite stores -0.0 as 0.0
      return add_integer(std::bit_cast<std::uint64_t>(sqlite3_value_double(value) + 0.0), crc);
    case SQLITE_NULL:
      return crc;
    default: {
      const Bytes bytes = bytes_of(value);
      return crc32c(bytes, add_integer(bytes.size(), crc));
    }
  }
}

void row_crc(sqlite3_context* context, int count, sqlite3_value** values) {
  std::uint32_t crc = 0;
  for (sqlite3_value* const value : std::span(values, static_cast<std::size_t>(count)))
    crc = add_value(value, crc);
  sqlite3_result_int64(context, std::int64_t{crc});
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts)
    text += (text.empty() ? "" : ", ") + part;
  return text;
}

/// \param value  SQL for the value of a column, by its place.
template <typename Value>
std::string checksum_of(const CheckedTable& table, Value value) {
  std::vector<std::string> arguments;
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    if (contains(kLargeBlobs, table.columns[i]))
      arguments.push_back("length(" + value(i) + ")");
    else if (!contains(kLargeOfRobot, table.columns[i]))
      arguments.push_back(value(i));
  return "row_crc(" + joined(arguments) + ")";
}

/// SQL that finds the new row.
std::string finds_new(const CheckedTable& table) {
  std::string condition;
  for (const std::string& key : table.keys)
    condition += (condition.empty() ? "" : " AND ") + key + " = NEW." + key;
  return condition;
}

std::string triggers_of(const std::string& name, const CheckedTable& table) {
  const auto begin = [&](const std::string& trigger) {
    return "DROP TRIGGER IF EXISTS temp." + name + trigger + "; CREATE TEMP TRIGGER " + name +
           trigger;
  };
  const std::string changed = " UPDATE OF " + joined(table.columns) + " ON main." + name;
  const std::string write = " BEGIN UPDATE " + name +
                            " SET row_crc32c = " + table.checksum("NEW.") + " WHERE " +
                            finds_new(table) + "; END;";
  std::string sql = begin("_inserted") + " AFTER INSERT ON main." + name +
                    " WHEN NEW.row_crc32c = 0" + write + begin("_changed") + " AFTER" + changed +
                    write;
  if (contains(kUpdatedInPart, name))
    sql += begin("_is_sound") + " BEFORE" + changed + " WHEN OLD.row_crc32c IS NOT " +
           table.checksum("OLD.") + " BEGIN SELECT RAISE(ABORT, '" + name +
           std::string(kRowIsDamaged) + "'); END;";
  return sql;
}

}  // namespace

std::string CheckedTable::checksum(std::string_view row) const {
  return checksum_of(*this, [&](std::size_t column) { return std::string(row) + columns[column]; });
}

void add_checksum_function(sqlite3& connection) {
  constexpr int kAnyNumber = -1;
  const int code = sqlite3_create_function_v2(&connection, "row_crc", kAnyNumber,
                                              SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_INNOCUOUS,
                                              nullptr, row_crc, nullptr, nullptr, nullptr);
  if (code != SQLITE_OK)
    throw_sqlite_error(connection, "row_crc");
}

std::map<std::string, CheckedTable, std::less<>> read_checked_tables(sqlite3& connection) {
  Statement names(connection, "SELECT name FROM main.sqlite_master WHERE type = 'table'");
  Statement columns(connection, "SELECT name, pk FROM pragma_table_info(?)");
  std::map<std::string, CheckedTable, std::less<>> tables;
  while (names.step()) {
    CheckedTable table;
    bool is_checked = false;
    columns.bind(1, names.column_text(0));
    while (columns.step()) {
      const std::string column(columns.column_text(0));
      if (column == kChecksum)
        is_checked = true;
      else
        table.columns.push_back(column);
      if (columns.column_integer(1) > 0)
        table.keys.push_back(column);
    }
    columns.reset();
    if (is_checked)
      tables.emplace(names.column_text(0), std::move(table));
  }
  return tables;
}

std::string checksum_triggers(const std::map<std::string, CheckedTable, std::less<>>& tables) {
  std::string sql;
  for (const auto& [name, table] : tables)
    sql += triggers_of(name, table);
  return sql;
}

std::string insert_with_checksum(const std::string& name, const CheckedTable& table,
                                 const std::vector<std::string>& columns) {
  const auto place_of = [&](const std::string& column) {
    return "?" + std::to_string(1 + (std::ranges::find(columns, column) - columns.begin()));
  };
  if (!std::ranges::is_permutation(columns, table.columns))
    throw std::logic_error("an INSERT into " + name + " has not its columns");
  std::vector<std::string> places;
  for (const std::string& column : columns)
    places.push_back(place_of(column));
  return "INSERT INTO " + name + " (" + joined(columns) + ", row_crc32c) VALUES (" +
         joined(places) + ", " +
         checksum_of(table, [&](std::size_t i) { return place_of(table.columns[i]); }) + ")";
}

}  // namespace kinship::store
