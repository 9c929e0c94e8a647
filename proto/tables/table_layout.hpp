#pragma once

#include <cstddef>
#include <iosfwd>

namespace kinship::tables {

/// How tables are laid out on a stream.
struct TableLayout {
  std::size_t width = 80;  ///< columns of text at most, where the table can be made to fit
  bool is_wide = false;    ///< every column, whole, however wide that is
};

/// Has tables that are printed on a stream from now on laid out so.
void set_table_layout(std::ostream& out, const TableLayout& layout);

/// What was set, or TableLayout() for a stream of which nobody said anything.
TableLayout table_layout(std::ostream& out);

/// Columns of text of the terminal that standard output is; that of TableLayout() if it is none.
std::size_t width_of_terminal();

}  // namespace kinship::tables
