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

/// Settings of a target that begin so are gone once the move is done.
inline constexpr std::string_view kPairRecord = "moving_pair.";

/// A store that is read from, or filled, row by row, past the interface that servers have. Used by
/// one thread. What is written is in a transaction. Methods throw Failure(Storage).
class Side {
 public:
  Side() = default;
  Side(const Side&) = delete;
  Side& operator=(const Side&) = delete;
  virtual ~Side() = default;

  virtual const std::string& name() const = 0;  ///< without a password
  /// The same for each way to name it, and another one's for no other.
  virtual std::string identity() = 0;
  virtual Uuid epoch() = 0;  ///< the newest; zero: no server had it open

  /// Runs readings that see one state of it. Short: a server may wait for their end.
  virtual void in_snapshot(const std::function<void()>& read) = 0;
  std::vector<MovedRow> all(const MovedTable& table);
  /// The row of `experience`; empty: there is none.
  MovedRow experience_of(const Pair& pair);
  /// Those of the ids that are there, in the order of ids.
  virtual std::vector<MovedRow> of_ids(const MovedTable& table,
                                       std::span<const std::int64_t> ids) = 0;
  /// By id. \param pair  of a table that is read by pairs.
  virtual std::vector<LightRow> light(const MovedTable& table, const Pair& pair);
  std::vector<LightRow> light(const MovedTable& table) { return light(table, {}); }

  std::string setting(std::string_view key);  ///< empty: none
  void put_setting(std::string_view key, const std::optional<std::string>& value);

  /// Who has it open, in words; empty: nobody. Where it can be, it is kept closed from then on.
  virtual std::string served_by() = 0;
  /// Differs once anybody else has written reports.
  virtual std::string writes_seen() = 0;
  /// Whether there is anything in it that a move would bring, or mix with.
  virtual bool has_content();

  /// What a crash takes of it is copied again.
  virtual void in_transaction(const std::function<void()>& write) = 0;
  /// The last one: it and all before it are durable on return.
  virtual void in_last_transaction(const std::function<void()>& write) = 0;
  /// Only this object may write from now on: transactions of others that claimed it fail.
  virtual void claim() = 0;
  /// Inserts rows, or replaces those of their keys.
  virtual void write(const MovedTable& table, std::span<const MovedRow> rows) = 0;
  virtual void erase(const MovedTable& table, std::span<const MovedRow> rows) = 0;
  /// Makes what follows from the rows: counters of ids, what one engine alone keeps.
  virtual void complete() = 0;
  void add_audit(const AuditEntry& entry);
  /// Removes all that a move wrote, and the claim.
  virtual void remove_all() = 0;

 protected:
  /// How an engine gives the rows of a table, as SQL.
  struct Selection {
    std::string columns, from, condition;
    const std::string& light;
  };
  virtual Selection selection_of(const MovedTable& table) const = 0;
  virtual Session& session() = 0;
  /// Of a failure of the engine one that names the store; nothing of any other.
  virtual std::optional<Failure> naming_store(const Failure& failure) const = 0;

  /// Runs what may meet a failure of the engine.
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

/// A file that is moved from. A server may have it open: then it is read beside that, in short
/// snapshots, and never written; else its lock is held.
/// \throws Failure(NotFound) if it is not there; Failure(Storage) if it is no store of today's
///         schema.
std::unique_ptr<Side> open_sqlite_source(const std::filesystem::path& file);

/// A file that is moved to, made if it is not there; its lock is held.
/// \throws Failure(Unavailable) if a server has it open.
std::unique_ptr<Side> open_sqlite_target(const std::filesystem::path& file);

/// A database that is moved from. Servers may have it open.
/// \throws Failure(NotFound) if there is no store in it; Failure(Storage), Failure(InvalidInput).
std::unique_ptr<Side> open_postgres_source(const std::string& url);

/// A database that is moved to; it gets our tables if it has none.
std::unique_ptr<Side> open_postgres_target(const std::string& url);

}  // namespace kinship::store::moving
