#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/session.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace kinship::store {

/// A prepared statement: the owner of one sqlite3_stmt, and its current row. Move-only; used by one
/// thread at a time.
///
/// Every method throws SqliteError with SQLite's own message on an unexpected return code.
class Statement final : public Row {
 public:
  Statement(sqlite3& connection, std::string_view sql);

  /// \param index  of `?`, from 1, or the number of `?1` or `$1`.
  Statement& bind(int index, std::int64_t value);
  Statement& bind(int index, double value);            ///< NaN becomes NULL
  Statement& bind(int index, std::string_view value);  ///< copies the text
  Statement& bind(int index, Bytes value);             ///< copies the bytes
  Statement& bind(int index, std::nullopt_t);          ///< NULL
  Statement& bind(int index, const Parameter& value);
  template <typename Value>
  Statement& bind(int index, const std::optional<Value>& value) {
    return value ? bind(index, *value) : bind(index, std::nullopt);
  }

  /// Binds the value of a column of another statement's row.
  Statement& bind_column(int index, const Statement& row, int column);

  /// Binds the first parameters in order.
  template <typename... Values>
  Statement& bind_all(const Values&... values) {
    int index = 0;
    (bind(++index, values), ...);
    return *this;
  }

  bool step();  ///< true: a row is ready; false: done
  bool next() override { return step(); }
  int columns() const noexcept override;
  void run();             ///< for a statement without rows: step to the end
  void reset() noexcept;  ///< ready to be bound and stepped again, without parameters

  std::int64_t column_integer(int column) const noexcept override;
  double column_real(int column) const noexcept override;
  std::string_view column_text(int column) const noexcept override;
  Bytes column_blob(int column) const noexcept override;
  bool column_is_null(int column) const noexcept override;

 private:
  void check(int code);
  void release() noexcept override { reset(); }
  int place_of(int index) const noexcept;

  struct Finalize {
    void operator()(sqlite3_stmt* statement) const noexcept;
  };
  sqlite3* connection_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  std::vector<int> places_;  // of $1, $2, ..., which SQLite numbers as it meets them; else empty
};

}  // namespace kinship::store
