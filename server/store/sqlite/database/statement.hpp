#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/store/values/bytes.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace kinship::store {

/// A prepared statement: the owner of one sqlite3_stmt. Move-only; used by one thread at a time.
///
/// Every method throws SqliteError with SQLite's own message on an unexpected return code.
class Statement {
 public:
  Statement(sqlite3& connection, std::string_view sql);

  Statement& bind(int index, std::int64_t value);      ///< index counts from 1, as in SQL
  Statement& bind(int index, double value);            ///< NaN becomes NULL
  Statement& bind(int index, std::string_view value);  ///< copies the text
  Statement& bind(int index, Bytes value);             ///< copies the bytes
  Statement& bind(int index, std::nullopt_t);          ///< NULL
  template <typename Value>
  Statement& bind(int index, const std::optional<Value>& value) {
    return value ? bind(index, *value) : bind(index, std::nullopt);
  }

  /// Binds what stands in a column of another statement's row.
  Statement& bind_column(int index, const Statement& row, int column);

  /// Binds the first parameters in order.
  template <typename... Values>
  Statement& bind_all(const Values&... values) {
    int index = 0;
    (bind(++index, values), ...);
    return *this;
  }

  bool step();            ///< true: a row is ready; false: done
  void run();             ///< for a statement without rows: step to the end
  void reset() noexcept;  ///< ready to be bound and stepped again, without parameters

  std::int64_t column_integer(int column) const noexcept;  ///< columns count from 0
  double column_real(int column) const noexcept;
  std::string_view column_text(int column) const noexcept;  ///< valid until the next step()
  Bytes column_blob(int column) const noexcept;             ///< valid until the next step()
  bool column_is_null(int column) const noexcept;

 private:
  void check(int code);

  struct Finalize {
    void operator()(sqlite3_stmt* statement) const noexcept;
  };
  sqlite3* connection_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

}  // namespace kinship::store
