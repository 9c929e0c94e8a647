#pragma once

#include <span>

#include "server/store/moving/moved_row.hpp"
#include "server/store/moving/moved_tables.hpp"
#include "server/store/postgres/database/parameters.hpp"
#include "server/store/postgres/database/rows.hpp"

/// Cells as PostgreSQL gives and takes them.
namespace kinship::store::moving {

MovedRow read_row(const postgres::Row& row, const MovedTable& table);

/// "bigint[]" for integers.
const char* array_type_of(CellType type);

/// Adds a column of rows as one array.
void add_column(postgres::Parameters& parameters, std::span<const MovedRow> rows,
                std::size_t column, CellType type);

}  // namespace kinship::store::moving
