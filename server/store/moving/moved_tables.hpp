#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

/// The tables that make up a store, in words that hold for both engines.
namespace kinship::store::moving {

/// What stands in a column: nothing, a number, or the bytes of a text or blob.
using Cell = std::variant<std::monostate, std::int64_t, double, std::string>;

/// A row of a table as both engines have it: the cells of its columns, the key first.
using MovedRow = std::vector<Cell>;

/// What tells that a row with an id has changed, without its blobs: the id and what may change.
using LightRow = std::array<std::int64_t, 4>;

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
  std::string sqlite = {};  ///< how SQLite gives it; empty: by its name
  bool is_aside = false;    ///< a mark of damage, which SQLite keeps in a table of its own
};

/// How a table is compared and copied.
enum class Reading {
  Whole,   ///< all at once: its rows are few
  ById,    ///< by its ids: rows are added, or change as the light rows say
  ByPair,  ///< the same, but of a robot and task, whose row of `experience` tells any change
};

struct MovedTable {
  std::string name;
  Reading reading = Reading::Whole;
  std::size_t keys = 1;  ///< columns that make up its key
  std::vector<MovedColumn> columns = {};
  std::string sqlite_from = {};         ///< empty: its name
  std::string sqlite_condition = {};    ///< empty: all rows
  std::string postgres_condition = {};  ///< empty: all rows
  /// The light rows by id, at most 4 columns; of a pair its task's and its robot's ids are the
  /// parameters.
  std::string sqlite_light = {};
  std::string postgres_light = {};
  int aside_kind = 0;          ///< of SQLite's set_aside; 0: none
  bool is_in_arrival = false;  ///< PostgreSQL keeps in which transaction a row came

  std::size_t column(const std::string& name) const;  ///< its place. \throws std::logic_error
};

/// The names of the first columns, with commas between.
std::string listed(const MovedTable& table, std::size_t count);

/// All of them; what refers to another one comes after it.
std::span<const MovedTable> moved_tables();
/// \throws std::logic_error if there is none.
const MovedTable& moved_table(const std::string& name);

}  // namespace kinship::store::moving
