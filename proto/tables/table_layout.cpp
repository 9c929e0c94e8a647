#include "proto/tables/table_layout.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <ostream>

namespace kinship::tables {
namespace {

/// Where a stream keeps its layout: width + 1, so that 0 is a stream without one.
int place_of_width() {
  static const int place = std::ios_base::xalloc();
  return place;
}

int place_of_wideness() {
  static const int place = std::ios_base::xalloc();
  return place;
}

}  // namespace

void set_table_layout(std::ostream& out, const TableLayout& layout) {
  out.iword(place_of_width()) = static_cast<long>(layout.width) + 1;
  out.iword(place_of_wideness()) = layout.is_wide ? 1 : 0;
}

TableLayout table_layout(std::ostream& out) {
  const long width = out.iword(place_of_width());
  if (width == 0)
    return {};
  return {static_cast<std::size_t>(width - 1), out.iword(place_of_wideness()) != 0};
}

std::size_t width_of_terminal() {
  winsize size{};
  if (isatty(STDOUT_FILENO) != 1 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 ||
      size.ws_col == 0)
    return TableLayout().width;
  return size.ws_col;
}

}  // namespace kinship::tables
