#pragma once

#include <cstddef>
#include <iosfwd>

namespace kinship::tables {

/// Layout of tables on a stream.
struct TableLayout {
  std::size_t width = 80;  ///< columns of text at most, if the table can be made to fit
  bool is_wide = false;    ///< every column in full, at any width
  bool cuts = true;        ///< what may be cut; else the table is wider than its width instead
};

/// Sets the layout of tables that are printed on a stream from now on.
void set_table_layout(std::ostream& out, const TableLayout& layout);

/// The layout set for a stream, or TableLayout() if none was set.
TableLayout table_layout(std::ostream& out);

/// The layout of standard output: as wide as its terminal; without one nothing is cut, as a program
/// may read it. Of another stream TableLayout().
TableLayout own_layout(const std::ostream& out);

/// Width of the terminal of standard output, columns of text; that of TableLayout() if it is not a
/// terminal.
std::size_t width_of_terminal();

}  // namespace kinship::tables
