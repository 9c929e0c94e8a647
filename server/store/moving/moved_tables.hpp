#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

/// The tables that make up a store, in words that hold for both engines.
namespace kinship::store::moving {

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

/// All of them; what refers to another one comes after it.
std::span<const MovedTable> moved_tables();
/// \throws std::logic_error if there is none.
const MovedTable& moved_table(const std::string& name);

}  // namespace kinship::store::moving
