#include "server/store/moving/postgres_cells.hpp"

#include <optional>
#include <string>
#include <vector>

#include "server/store/moving/read_cell.hpp"

namespace kinship::store::moving {
namespace {

/// What one type of array is made of. Texts and reals are never NULL in these tables.
template <typename Element, typename Make>
std::vector<Element> elements_of(std::span<const MovedRow> rows, std::size_t column, Make make) {
  std::vector<Element> elements;
  elements.reserve(rows.size());
  for (const MovedRow& row : rows)
    elements.push_back(make(row[column]));
  return elements;
}

std::optional<std::int64_t> integer_in(const Cell& cell) {
  const auto* const value = std::get_if<std::int64_t>(&cell);
  return value == nullptr ? std::nullopt : std::optional(*value);
}

std::optional<Bytes> bytes_in(const Cell& cell) {
  const auto* const value = std::get_if<std::string>(&cell);
  if (value == nullptr)
    return std::nullopt;
  return Bytes(reinterpret_cast<const std::uint8_t*>(value->data()), value->size());
}

}  // namespace

MovedRow read_row(const postgres::Row& row, const MovedTable& table) {
  MovedRow cells;
  cells.reserve(table.columns.size());
  for (int column = 0; column < std::ssize(table.columns); ++column)
    cells.push_back(read_cell(row, column, table.columns[static_cast<std::size_t>(column)].type));
  return cells;
}

const char* array_type_of(CellType type) {
  switch (type) {
    case CellType::Integer:
      return "bigint[]";
    case CellType::Real:
      return "double precision[]";
    case CellType::Text:
      return "text[]";
    case CellType::Blob:
      break;
  }
  return "bytea[]";
}

void add_column(postgres::Parameters& parameters, std::span<const MovedRow> rows,
                std::size_t column, CellType type) {
  switch (type) {
    case CellType::Integer:
      parameters.add(elements_of<std::optional<std::int64_t>>(rows, column, integer_in));
      return;
    case CellType::Real:
      parameters.add(elements_of<double>(rows, column,
                                         [](const Cell& cell) { return std::get<double>(cell); }));
      return;
    case CellType::Text:
      parameters.add(elements_of<std::string>(
          rows, column, [](const Cell& cell) { return std::get<std::string>(cell); }));
      return;
    case CellType::Blob:
      parameters.add(elements_of<std::optional<Bytes>>(rows, column, bytes_in));
      return;
  }
}

}  // namespace kinship::store::moving
