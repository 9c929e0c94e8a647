#include "server/store/sqlite/rows/damage_search.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"
#include "server/store/sqlite/rows/scene_rows.hpp"
#include "server/store/tables/distributions.hpp"
#include "server/store/tables/meshes.hpp"
#include "server/store/tables/rehearsals.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/tables/searches.hpp"

namespace kinship::store {
namespace {

std::string and_not_quarantined(const std::string& table) {
  return has_quarantine(table) ? " AND NOT " + in_quarantine(table) : std::string();
}

/// Contents that have a checksum of their own.
bool has_right_content(Database& database, const std::string& table, std::int64_t id) {
  if (table == "path")
    return is_path_decodable(database, id);
  if (table == "scene")
    return can_read_scene(database, id);
  if (table == "distribution")
    return read_distribution(database, id).distribution.has_value();
  if (table == "rehearsal")
    return is_rehearsal_sound(database, id);
  if (table == "search")
    return is_search_sound(database, id);
  if (table == "mesh")
    return is_mesh_sound(database, id);
  if (table == "robot")
    return is_robot_readable(database, id);
  return true;
}

/// SQL for the name of a row.
std::string name_of_row(const std::string& table, const CheckedTable& columns) {
  if (table == "evicted_distribution")
    return "lower(hex(digest))";
  std::string name;
  for (const std::string& key : columns.keys)
    name += (name.empty() ? "" : " || ' ' || ") + key;
  return name;
}

RowsChecked check_small_table(Database& database, const std::string& table) {
  RowsChecked checked;
  Statement rows(database.connection(),
                 "SELECT " + name_of_row(table, database.checked_tables().at(table)) + ", " +
                     database.is_intact(table) + " FROM " + table);
  while (rows.step()) {
    ++checked.rows;
    if (rows.column_integer(1) == 0)
      checked.damaged.emplace_back(rows.column_text(0));
  }
  return checked;
}

/// Also quarantined ones, as long as no other row stands for them.
bool has_damaged_rows(Database& database, const std::string& table) {
  return std::ranges::any_of(count_quarantined(database),
                             [&](const QuarantineCount& count) { return count.table == table; }) ||
         !check_rows(database, table, 0, std::numeric_limits<std::int64_t>::max()).damaged.empty();
}

bool has_sound_structure(Database& database, const std::string& table) try {
  return check_structure(database, table).empty();
} catch (const SqliteError& error) {
  if (!error.is_damage())
    throw;
  return false;
}

/// \return whether that mended the structure of the table; else nothing is changed. Entries of a
///         damaged row are kept, and two rows with one key are for a repair.
bool make_indexes_anew(Database& database, const std::string& table) try {
  if (has_damaged_rows(database, table))
    return false;
  Transaction whole(database, Transaction::Kind::Write);
  database.execute("REINDEX \"" + table + "\"");
  if (!has_sound_structure(database, table))
    return false;  // the table itself may have lost rows, of which the indexes know
  whole.commit();
  return true;
} catch (const SqliteError& error) {
  if (!error.is_damage() && !error.concerns_one_row())
    throw;
  return false;
}

}  // namespace

std::vector<std::string> tables_of(Database& database) {
  std::vector<std::string> names;
  Statement tables(database.connection(), "SELECT name FROM sqlite_master WHERE type = 'table'");
  while (tables.step())
    names.emplace_back(tables.column_text(0));
  std::ranges::sort(names);
  return names;
}

std::vector<std::string> check_structure(Database& database, const std::string& table) {
  std::vector<std::string> lines;
  Statement integrity(database.connection(),
                      "PRAGMA integrity_check" + (table.empty() ? "" : "('" + table + "')"));
  while (integrity.step()) {
    std::istringstream stream{std::string(integrity.column_text(0))};
    for (std::string line; std::getline(stream, line);)
      if (line != "ok" && !line.starts_with("*** in database"))
        lines.push_back(line);
  }
  return lines;
}

RowsChecked check_rows(Database& database, const std::string& table, std::int64_t after_id,
                       std::int64_t limit) {
  const auto columns = database.checked_tables().find(table);
  if (columns == database.checked_tables().end())
    return {};
  const std::vector<std::string>& keys = columns->second.keys;
  if (keys != std::vector<std::string>{"id"} && keys != std::vector<std::string>{"robot_id"})
    return check_small_table(database, table);
  const std::string id = keys.front();
  Statement rows(database.connection(), "SELECT " + id + ", " + database.is_intact(table) +
                                            " FROM " + table + " NOT INDEXED WHERE " + id + " > ?" +
                                            and_not_quarantined(table) + " ORDER BY " + id +
                                            " LIMIT ?");
  rows.bind_all(after_id, limit);
  RowsChecked checked{.last_id = after_id};
  while (rows.step()) {
    const std::int64_t row = rows.column_integer(0);  // a flipped one may be out of order
    checked.last_id = std::max(checked.last_id, row);
    ++checked.rows;
    if (rows.column_integer(1) != 0 && has_right_content(database, table, row))
      continue;
    checked.damaged.push_back(std::to_string(row));
    checked.damaged_ids.push_back(row);
  }
  checked.is_last = std::cmp_less(checked.rows, limit) || checked.last_id == after_id;
  return checked;
}

bool is_dropped_if_damaged(std::string_view table) {
  return table == "rehearsal" || table == "search" || table == "mesh";
}

void DamageItem::apply(Batch& batch) {
  std::erase_if(rows_, [&](std::int64_t row) {
    return check_rows(batch.database(), table_, row - 1, 1).damaged_ids !=
           std::vector<std::int64_t>{row};
  });
  if (table_ == "path")
    return quarantine_paths(batch, rows_);
  for (const std::int64_t row : rows_)
    if (table_ == "rehearsal")
      drop_rehearsal(batch.database(), row);
    else if (table_ == "search")
      drop_search(batch.database(), row);
    else if (table_ == "mesh")
      drop_mesh(batch.database(), row);
    else
      quarantine_row(batch.database(), table_, row);
}

std::optional<std::string> find_damaged_row(Database& database) {
  for (const auto& [table, columns] : database.checked_tables()) {
    Statement row(database.connection(), "SELECT " + name_of_row(table, columns) + " FROM " +
                                             table + " WHERE NOT " + database.is_intact(table) +
                                             and_not_quarantined(table) + " LIMIT 1");
    if (row.step())
      return "table " + table + ": row " + std::string(row.column_text(0));
  }
  return std::nullopt;
}

std::vector<std::string> mend_indexes(Database& database) {
  if (database.integer("PRAGMA page_count") * database.integer("PRAGMA page_size") >
      kMaxBytesOfAStart)
    return {};
  if (has_sound_structure(database, ""))
    return {};
  std::vector<std::string> mended;
  for (const std::string& table : tables_of(database))
    if (!has_sound_structure(database, table) && make_indexes_anew(database, table))
      mended.push_back("the indexes of table " + table +
                       " did not fit its rows and were made anew");
  return mended;
}

}  // namespace kinship::store
