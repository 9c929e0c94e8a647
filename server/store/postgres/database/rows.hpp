#pragma once

#include <cstdint>
#include <iterator>
#include <memory>
#include <string_view>

#include "server/store/postgres/database/parameters.hpp"

struct pg_result;

namespace kinship::store::postgres {

/// One row of a result, borrowed from its Rows. Columns count from 0. A NULL is 0 or empty, as in
/// SQLite. A column of another type than requested is a mistake in the statement: std::logic_error.
class Row {
 public:
  Row(const pg_result& result, int row) : result_(&result), row_(row) {}

  std::int64_t column_integer(int column) const;  ///< smallint, integer, bigint, boolean
  double column_real(int column) const;           ///< double precision
  std::string_view column_text(int column) const noexcept;
  Bytes column_blob(int column) const noexcept;
  bool column_is_null(int column) const noexcept;

 private:
  const pg_result* result_;
  int row_;
};

/// The rows of a statement: the owner of one PGresult, in binary format. Move-only.
class Rows {
 public:
  explicit Rows(pg_result* result) : result_(result) {}

  const pg_result* get() const noexcept { return result_.get(); }
  int size() const noexcept;
  int columns() const noexcept;
  bool empty() const noexcept { return size() == 0; }
  Row operator[](int row) const { return {*result_, row}; }
  Row front() const { return {*result_, 0}; }
  std::int64_t changed() const;                   ///< rows that INSERT, UPDATE or DELETE touched
  std::string_view command_tag() const noexcept;  ///< "COMMIT", "INSERT 0 1", ...

  class Iterator {
   public:
    using difference_type = int;
    using value_type = Row;
    Iterator(const pg_result* result, int row) : result_(result), row_(row) {}
    Row operator*() const { return {*result_, row_}; }
    Iterator& operator++() {
      ++row_;
      return *this;
    }
    bool operator==(const Iterator& other) const noexcept { return row_ == other.row_; }

   private:
    const pg_result* result_;
    int row_;
  };
  Iterator begin() const { return {result_.get(), 0}; }
  Iterator end() const { return {result_.get(), size()}; }

 private:
  struct Clear {
    void operator()(pg_result* result) const noexcept;
  };
  std::unique_ptr<pg_result, Clear> result_;
};

}  // namespace kinship::store::postgres
