#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"

/// The search for damage in a store's tables, in slices. Each throws SqliteError if it meets a page
/// that SQLite cannot read.
namespace kinship::store {

/// The names of all tables, in order.
std::vector<std::string> tables_of(Database& database);

/// What SQLite's integrity_check says about a table and its indexes; of all, with the pages that
/// belong to none, if the name is empty. It reads all their pages.
/// \return a line each; empty: nothing is wrong.
std::vector<std::string> check_structure(Database& database, const std::string& table);

/// Rows of a table that were checked.
struct RowsChecked {
  std::uint64_t rows = 0;
  std::int64_t last_id = 0;
  bool is_last = true;  ///< no row is left; a table without ids is checked at once
  std::vector<std::string> damaged = {};  ///< names of rows whose checksum is wrong
  std::vector<std::int64_t> damaged_ids = {};
};

/// Checks the next rows of a table by their ids, without those in quarantine: their checksums, and
/// those of their contents.
RowsChecked check_rows(Database& database, const std::string& table, std::int64_t after_id,
                       std::int64_t limit);

/// Whether damaged rows of a table are dropped: nothing refers to them, and they are made anew or
/// explain only.
bool is_dropped_if_damaged(std::string_view table);

/// Quarantines damaged rows that a reader found, or drops them (is_dropped_if_damaged); if it
/// fails, the next reader finds them again.
class DamageItem : public WriteItem {
 public:
  /// \param table  one with a quarantine, or whose damaged rows are dropped.
  DamageItem(std::string table, std::vector<std::int64_t> rows)
      : table_(std::move(table)), rows_(std::move(rows)) {}

  /// An index may have led to a row that is sound: each is looked at again.
  void apply(Batch& batch) override;
  void finish(const Error* /*error*/) override {}

 private:
  std::string table_;
  std::vector<std::int64_t> rows_;
};

/// The name of a row with a wrong checksum that is not in quarantine, of any table. It does not
/// read contents.
std::optional<std::string> find_damaged_row(Database& database);

/// Makes indexes anew whose entries do not fit the rows of their table, if all of its rows are as
/// they were written and that mends its structure. Reads the whole store; one of more than
/// kMaxBytesOfAStart is left to the scrub.
/// \return a line for each table.
std::vector<std::string> mend_indexes(Database& database);

inline constexpr std::int64_t kMaxBytesOfAStart = std::int64_t{64} << 20U;

}  // namespace kinship::store
