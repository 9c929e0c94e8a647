#include "proto/tables/table_layout.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <iostream>

namespace kinship::tables {
namespace {

/// Where a stream keeps its layout: width + 1, so that 0 is a stream without one.
int place_of_width() {
  static const int place = std::ios_base::xalloc();
  return place;
}

/// Where it keeps the rest of it.
int place_of_flags() {
  static const int place = std::ios_base::xalloc();
  return place;
}

constexpr long kWide = 1, kUncut = 2;

}  // namespace

void set_table_layout(std::ostream& out, const TableLayout& layout) {
  out.iword(place_of_width()) = static_cast<long>(layout.width) + 1;
  out.iword(place_of_flags()) = (layout.is_wide ? kWide : 0) | (layout.cuts ? 0 : kUncut);
}

TableLayout table_layout(std::ostream& out) {
  const long width = out.iword(place_of_width()), flags = out.iword(place_of_flags());
  if (width == 0)
    return {};
  return {static_cast<std::size_t>(width - 1), (flags & kWide) != 0, (flags & kUncut) == 0};
}

TableLayout own_layout(const std::ostream& out) {
  if (&out != &std::cout)
    return {};
  return {.width = width_of_terminal(), .cuts = isatty(STDOUT_FILENO) == 1};
}

std::size_t width_of_terminal() {
  winsize size{};
  if (isatty(STDOUT_FILENO) != 1 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 ||
      size.ws_col == 0)
    return TableLayout().width;
  return size.ws_col;
}

}  // namespace kinship::tables
