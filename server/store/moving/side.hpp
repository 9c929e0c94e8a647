#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/moving/moved_tables.hpp"
#include "server/store/session.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store::moving {

/// Prefix of settings of a target that are deleted once the move is done.
inline constexpr std::string_view kPairRecord = "moving_pair.";

/// The source or target of a move: a store read or filled row by row, without the interface of
/// servers. Used by one thread. Writes need a transaction. Methods throw Failure(Storage).
class Side {
 public:
  Side() = default;
  Side(const Side&) = delete;
  Side& operator=(const Side&) = delete;
  virtual ~Side() = default;

  virtual const std::string& name() const = 0;  ///< without a password
  /// Identifies the store: equal for all its names, different for other stores.
  virtual std::string identity() = 0;
  virtual Uuid epoch() = 0;  ///< the newest; zero: no server had it open

  /// Runs readings in one state of the store. Keep them short: a server may wait for their end.
  virtual void in_snapshot(const std::function<void()>& read) = 0;
  std::vector<MovedRow> all(const MovedTable& table);
  /// The row of `experience`; empty: there is none.
  MovedRow experience_of(const Pair& pair);
  /// The rows with these ids that exist, in order of ids.
  virtual std::vector<MovedRow> of_ids(const MovedTable& table,
                                       std::span<const std::int64_t> ids) = 0;
  /// In order of ids. \param pair  for a table that is read by pairs.
  virtual std::vector<RowFingerprint> light(const MovedTable& table, const Pair& pair);
  std::vector<RowFingerprint> light(const MovedTable& table) { return light(table, {}); }

  std::string setting(std::string_view key);  ///< empty: none
  void put_setting(std::string_view key, const std::optional<std::string>& value);

  /// The servers that have it open, as text; empty: none. Then a file is locked against servers
  /// from now on.
  virtual std::string served_by() = 0;
  /// A text that changes once another program has written reports.
  virtual std::string writes_seen() = 0;
  /// Whether it has rows that a move copies or that would mix with them.
  virtual bool has_content();

  /// Need not be durable on return: rows lost in a crash are copied again.
  virtual void in_transaction(const std::function<void()>& write) = 0;
  /// The last transaction: it and all earlier ones are durable on return.
  virtual void in_last_transaction(const std::function<void()>& write) = 0;
  /// Only this object may write from now on: transactions of earlier claims fail.
  virtual void claim() = 0;
  /// Inserts rows, or replaces the rows of their keys.
  virtual void write(const MovedTable& table, std::span<const MovedRow> rows) = 0;
  virtual void erase(const MovedTable& table, std::span<const MovedRow> rows) = 0;
  /// Derives data from the rows: counters of ids, and data of one engine only.
  virtual void complete() = 0;
  void add_audit(const AuditEntry& entry);
  /// Removes all rows that a move wrote, and the claim.
  virtual void remove_all() = 0;

 protected:
  /// SQL of an engine for the rows of a table.
  struct Selection {
    std::string columns, from, condition;
    const std::string& light;
  };
  virtual Selection selection_of(const MovedTable& table) const = 0;
  virtual Session& session() = 0;
  /// A failure of the engine with the store's name added; nothing for other failures.
  virtual std::optional<Failure> naming_store(const Failure& failure) const = 0;

  /// Runs a function; adds the store's name to a failure of the engine.
  template <typename Function>
  std::invoke_result_t<Function> named(Function function) const {
    try {
      return function();
    } catch (const Failure& failure) {
      if (const std::optional<Failure> with_name = naming_store(failure))
        throw Failure(*with_name);
      throw;
    }
  }
};

/// \param row  of the columns of a table, of either engine.
template <Columns Row>
MovedRow read_row(const Row& row, const MovedTable& table) {
  MovedRow cells;
  cells.reserve(table.columns.size());
  for (int column = 0; column < std::ssize(table.columns); ++column) {
    const CellType type = table.columns[static_cast<std::size_t>(column)].type;
    Cell& cell = cells.emplace_back();
    if (row.column_is_null(column))
      continue;
    if (type == CellType::Integer)
      cell = row.column_integer(column);
    else if (type == CellType::Real)
      cell = row.column_real(column);
    else if (type == CellType::Text)
      cell = std::string(row.column_text(column));
    else
      cell = std::string(row.column_blob(column).begin(), row.column_blob(column).end());
  }
  return cells;
}

/// A file as the source. If a server has it open, it is read in short snapshots and never written;
/// else its lock is held.
/// \throws Failure(NotFound) if it does not exist; Failure(Storage) if it is no store of today's
///         schema.
std::unique_ptr<Side> open_sqlite_source(const std::filesystem::path& file);

/// A file as the target, made if missing; its lock is held.
/// \throws Failure(Unavailable) if a server has it open.
std::unique_ptr<Side> open_sqlite_target(const std::filesystem::path& file);

/// A database as the source. Servers may have it open.
/// \throws Failure(NotFound) if there is no store in it; Failure(Storage), Failure(InvalidInput).
std::unique_ptr<Side> open_postgres_source(const std::string& url);

/// A database as the target; it gets the tables of a store if it has none.
std::unique_ptr<Side> open_postgres_target(const std::string& url);

}  // namespace kinship::store::moving
