#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// The tables of a store, described for both engines.
namespace kinship::store::moving {

/// The value of a column: nothing, a number, or the bytes of a text or blob.
using Cell = std::variant<std::monostate, std::int64_t, double, std::string>;

/// A row of a table, equal in both engines: the cells of its columns, the key first.
using MovedRow = std::vector<Cell>;

/// Tells a change of a row with an id, without its blobs: the id and the columns that may change.
using RowFingerprint = std::array<std::int64_t, 4>;

/// The experience of a robot with a task.
struct Pair {
  std::int64_t task_id = 0;
  std::int64_t robot_id = 0;
};

inline std::int64_t integer_of(const MovedRow& row, std::size_t column) {
  const auto* const value = std::get_if<std::int64_t>(&row[column]);
  return value == nullptr ? 0 : *value;
}

enum class CellType { Integer, Real, Text, Blob };

struct MovedColumn {
  std::string name;
  CellType type = CellType::Integer;
  std::string sqlite = {};        ///< its expression in SQLite; empty: its name
  bool is_of_quarantine = false;  ///< SQLite has it in table quarantine
};

/// How a table is compared and copied.
enum class Reading {
  Whole,   ///< all at once: its rows are few
  ById,    ///< by ids: rows are added, or change as their light rows tell
  ByPair,  ///< the same per robot and task, whose row of `experience` tells any change
};

struct MovedTable {
  std::string name;
  Reading reading = Reading::Whole;
  std::size_t keys = 1;  ///< columns that make up its key
  std::vector<MovedColumn> columns = {};
  std::string sqlite_from = {};         ///< empty: its name
  std::string sqlite_condition = {};    ///< empty: all rows
  std::string postgres_condition = {};  ///< empty: all rows
  /// Queries of the light rows in order of ids, at most 4 columns; for a pair the parameters are
  /// the ids of its task and robot.
  std::string sqlite_light = {};
  std::string postgres_light = {};
  bool has_quarantine = false;  ///< rows that SQLite quarantines and PostgreSQL marks as damaged
  bool is_in_arrival = false;   ///< PostgreSQL keeps the transaction of each row

  std::size_t column(const std::string& name) const;  ///< its place. \throws std::logic_error
};

/// The names of the first columns, with commas between.
std::string listed(const MovedTable& table, std::size_t count);

/// All tables; a table comes after those that it refers to.
std::span<const MovedTable> moved_tables();
/// \throws std::logic_error if there is none.
const MovedTable& moved_table(std::string_view name);

}  // namespace kinship::store::moving
