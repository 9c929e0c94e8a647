#pragma once

#include <string>

#include "server/store/moving/moved_row.hpp"
#include "server/store/moving/moved_tables.hpp"

namespace kinship::store::moving {

/// What people know a row by: "path 7 (report 0194...)".
std::string describe_row(const MovedTable& table, const MovedRow& row);

/// Whether a row bears a mark of damage, or its checksum is wrong.
bool is_damaged(const MovedTable& table, const MovedRow& row);

}  // namespace kinship::store::moving
