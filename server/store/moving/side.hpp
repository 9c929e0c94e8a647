#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/moving/moved_row.hpp"
#include "server/store/moving/moved_tables.hpp"

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
  virtual std::vector<MovedRow> all(const MovedTable& table) = 0;
  /// The row of `experience`; empty: there is none.
  virtual MovedRow experience_of(const Pair& pair) = 0;
  /// Those of the ids that are there, in the order of ids.
  virtual std::vector<MovedRow> of_ids(const MovedTable& table,
                                       std::span<const std::int64_t> ids) = 0;
  /// By id. \param pair  of a table that is read by pairs.
  virtual std::vector<LightRow> light(const MovedTable& table, const Pair& pair) = 0;
  std::vector<LightRow> light(const MovedTable& table) { return light(table, {}); }

  virtual std::string setting(std::string_view key) = 0;  ///< empty: none
  virtual void put_setting(std::string_view key, const std::optional<std::string>& value) = 0;

  /// Who has it open, in words; empty: nobody. Where it can be, it is kept closed from then on.
  virtual std::string served_by() = 0;
  /// Differs once anybody else has written reports.
  virtual std::string writes_seen() = 0;
  /// Whether there is anything in it that a move would bring, or mix with.
  virtual bool has_content() = 0;

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
  virtual void add_audit(const AuditEntry& entry) = 0;
  /// Removes all that a move wrote, and the claim.
  virtual void remove_all() = 0;
};

}  // namespace kinship::store::moving
