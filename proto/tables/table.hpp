#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "proto/tables/table_layout.hpp"

namespace kinship::tables {

/// Treatment of a column if a table is wider than its layout.
enum class Fit {
  Words,  ///< wraps to a second line between words: no text is lost
  Cut,    ///< loses its end, marked by "..": never for a name that the next command needs
  Wide    ///< shown by a wide layout only
};

struct Column {
  // NOLINTNEXTLINE(google-explicit-constructor): a heading is a column
  Column(const char* text, Fit how = Fit::Words) : heading(text), fit(how) {}
  Column(std::string text, Fit how) : heading(std::move(text)), fit(how) {}

  std::string heading;
  Fit fit;
};

/// Text in aligned columns, two spaces apart; numbers to the right. It fits the layout of the
/// stream (table_layout.hpp), unless columns that must stay whole are wider.
class Table {
 public:
  explicit Table(std::vector<Column> columns);

  /// \throws std::invalid_argument unless there is one cell per column.
  void add_row(std::vector<std::string> cells);

  /// Headings and rows; only `(none)` if there are no rows.
  void print(std::ostream& out) const;

 private:
  std::vector<std::size_t> shown(bool is_wide) const;
  std::vector<std::size_t> widths(const std::vector<std::size_t>& columns,
                                  const TableLayout& layout) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;  // headings first
};

}  // namespace kinship::tables
