#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "proto/types/failure.hpp"
#include "server/store/values/bytes.hpp"

/// The interface of an engine to the statements of server/store/tables.
namespace kinship::store {

/// A value that is bound to a parameter of a statement. Borrows texts and bytes.
class Parameter {
 public:
  using Value = std::variant<std::int64_t, double, std::string_view, Bytes>;

  explicit Parameter(std::integral auto value) : value_(static_cast<std::int64_t>(value)) {}
  explicit Parameter(double value) : value_(value) {}
  explicit Parameter(std::string_view value) : value_(value) {}
  explicit Parameter(const std::string& value) : Parameter(std::string_view(value)) {}
  explicit Parameter(const char* value) : Parameter(std::string_view(value)) {}
  explicit Parameter(Bytes value) : value_(value) {}
  explicit Parameter(const std::vector<std::uint8_t>& value) : Parameter(Bytes(value)) {}
  /// A Digest or Uuid.
  template <typename Id>
  requires requires(const Id& id) { Bytes(id.bytes); }
  explicit Parameter(const Id& id) : Parameter(Bytes(id.bytes)) {}
  /// A value, or NULL of its type.
  template <typename Optional>
  explicit Parameter(const std::optional<Optional>& value)
      : Parameter(value ? Parameter(*value) : Parameter(Optional{})) {
    is_null_ = !value;
    if (is_null_)  // what it borrowed is no more
      value_ = std::visit([](auto each) { return Value(decltype(each){}); }, value_);
  }

  bool is_null() const noexcept { return is_null_; }
  const Value& value() const noexcept { return value_; }  ///< of a NULL only its type counts

 private:
  Value value_;
  bool is_null_ = false;
};

/// A row of an answer; the next one takes its place. Columns count from 0; a NULL is 0 or empty.
/// Texts and bytes are valid until the next row.
class Row {
 public:
  virtual ~Row() = default;

  virtual bool next() = 0;  ///< false: there is none
  virtual int columns() const noexcept = 0;

  virtual std::int64_t column_integer(int column) const = 0;  ///< booleans too
  virtual double column_real(int column) const = 0;
  virtual std::string_view column_text(int column) const = 0;
  virtual Bytes column_blob(int column) const = 0;
  virtual bool column_is_null(int column) const = 0;

 private:
  friend class Rows;
  virtual void release() noexcept = 0;  ///< the statement is not used any more
};

/// The rows of a statement, to be read once, by a range-based for or the first alone. The
/// constructor runs a statement without rows to its end; the caller must read one that writes and
/// gives rows to its end.
class Rows {
 public:
  explicit Rows(Row& row) : row_(&row), has_row_(row_->next()) {}

  bool empty() const noexcept { return !has_row_; }
  const Row& front() const noexcept { return *row_; }  ///< while there is one

  class Iterator {
   public:
    explicit Iterator(Rows& rows) : rows_(&rows) {}
    const Row& operator*() const noexcept { return *rows_->row_; }
    Iterator& operator++() {
      rows_->has_row_ = rows_->row_->next();
      return *this;
    }
    bool operator==(std::default_sentinel_t) const noexcept { return rows_->empty(); }

   private:
    Rows* rows_;
  };
  Iterator begin() { return Iterator(*this); }
  static std::default_sentinel_t end() { return {}; }

 private:
  struct Release {
    void operator()(Row* row) const noexcept { row->release(); }
  };
  std::unique_ptr<Row, Release> row_;
  bool has_row_;
};

/// SQL that differs between the engines; each is empty where an engine needs none.
struct Dialect {
  // For other servers of the same database:
  std::string_view lock_robots = {};  ///< keeps them from changing robots
  std::string_view for_update = {};   ///< of a SELECT: locks the rows
  /// The same for table experience, whose keys stay readable.
  std::string_view lock_experience = {};
  std::string_view mark_changed = {};             ///< of an UPDATE: sets when the row was changed
  std::string_view note_gone_robot = {};          ///< before the robot $1 is deleted
  std::string_view note_former_task = {};         ///< of a task that was called $1
  std::string_view newest_attempts_first = {};    ///< of an ORDER BY
  std::string_view quarantine_distribution = {};  ///< a damaged one: of row $1, at time $2
  std::string_view by_task_robot = {};            ///< behind table path: reads an index alone
};

/// A connection to a database, used by one thread at a time. Statements are prepared once per text;
/// their parameters are $1, $2, ... A text must not run again while its rows are read.
///
/// Every method throws the engine's Failure(Storage).
class Session {
 public:
  Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  virtual ~Session() = default;

  virtual const Dialect& dialect() const noexcept = 0;
  /// SQL that says whether a row of a table is as it was written: true where the engine sees to it.
  virtual std::string is_intact(std::string_view /*table*/) { return "TRUE"; }
  /// SQL that says whether a row of table path, scene or distribution is quarantined.
  virtual std::string is_quarantined(std::string_view table) const = 0;
  /// For a look-up by an index on `column` that found nothing, in a table with ids: a damaged index
  /// may have led past the row. It looks at the next entries on both sides, which have to be in
  /// order and to fit their rows. Nothing where the engine sees to it, or if the value is there.
  /// \param value  of texts or bytes.
  virtual void require_absent(std::string_view /*table*/, std::string_view /*column*/,
                              const Parameter& /*value*/) {}

  template <typename... Values>
  Rows query(std::string_view sql, const Values&... values) {
    return query_with(sql, std::array<Parameter, sizeof...(Values)>{Parameter(values)...});
  }
  Rows query_with(std::string_view sql, std::span<const Parameter> parameters) {
    return Rows(run(sql, parameters));
  }

  /// \return the first column of the only row; nothing if there is no row.
  template <typename... Values>
  std::optional<std::int64_t> find_integer(std::string_view sql, const Values&... values) {
    std::optional<std::int64_t> found;
    for (const Row& row : query(sql, values...))
      found = row.column_integer(0);
    return found;
  }

  /// Runs a statement that writes; if it meets damage, it alone is undone.
  /// \return false if it was undone.
  template <typename... Values>
  bool try_change(std::string_view sql, const Values&... values) {
    return try_run(sql, std::array<Parameter, sizeof...(Values)>{Parameter(values)...});
  }

  /// \return the value of `read`; an empty one if it met damage.
  template <typename Read>
  std::invoke_result_t<Read> unless_damaged(Read read) const {
    try {
      return read();
    } catch (const Failure& failure) {
      if (!is_damage(failure))
        throw;
      return {};
    }
  }

 private:
  /// Binds the parameters; Row::next() runs it.
  virtual Row& run(std::string_view sql, std::span<const Parameter> parameters) = 0;
  virtual bool try_run(std::string_view sql, std::span<const Parameter> parameters) {
    query_with(sql, parameters);
    return true;
  }
  /// Whether a row or a page is damaged and others are sound.
  virtual bool is_damage(const Failure& /*failure*/) const noexcept { return false; }
};

}  // namespace kinship::store
