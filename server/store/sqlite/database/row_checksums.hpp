#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

struct sqlite3;

/// Checksums of rows. SQLite has none: a flipped bit is read as data.
///
/// A table with a column row_crc32c has in it the CRC-32C of the other columns of the row, but for
/// the one that holds a large text or blob, which has a checksum of its own; a blob counts with its
/// length. The columns that a statement reads from an index count as they stand
/// there, so that an entry that leads to another row is found as well.
namespace kinship::store {

/// The columns of a table with checksums.
struct CheckedTable {
  std::vector<std::string> columns;  ///< in order, without row_crc32c
  std::vector<std::string> keys;     ///< of its primary key

  /// SQL for the checksum of a row.
  /// \param row  before each column: "NEW.", "path.", or empty.
  std::string checksum(std::string_view row) const;
};

/// Adds to a connection the SQL function row_crc(...), the checksum of its arguments.
void add_checksum_function(sqlite3& connection);

/// The tables of a connection's schema that have checksums, by name.
std::map<std::string, CheckedTable, std::less<>> read_checked_tables(sqlite3& connection);

/// The triggers, of one connection alone, that give each row that it writes its checksum. An UPDATE
/// of a row whose checksum is wrong is refused where the tables' statements keep a part of the old
/// row (SqliteError::is_of_row()).
std::string checksum_triggers(const std::map<std::string, CheckedTable, std::less<>>& tables);

/// An INSERT with the checksum, for rows that a trigger would have to write twice.
/// \param columns  all of the table, in the order of the parameters.
/// \throws std::logic_error if they are not.
std::string insert_with_checksum(const std::string& name, const CheckedTable& table,
                                 const std::vector<std::string>& columns);

}  // namespace kinship::store
