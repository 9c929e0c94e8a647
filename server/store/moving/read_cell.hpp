#pragma once

#include <string>

#include "server/store/moving/moved_row.hpp"
#include "server/store/moving/moved_tables.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store::moving {

/// A column of a row of either engine.
template <Columns Row>
Cell read_cell(const Row& row, int column, CellType type) {
  if (row.column_is_null(column))
    return {};
  switch (type) {
    case CellType::Integer:
      return row.column_integer(column);
    case CellType::Real:
      return row.column_real(column);
    case CellType::Text:
      return std::string(row.column_text(column));
    case CellType::Blob:
      break;
  }
  const Bytes bytes = row.column_blob(column);
  return std::string(bytes.begin(), bytes.end());
}

}  // namespace kinship::store::moving
