#pragma once

#include <vector>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// Compares the rows that a damaged store had, by its indexes, with those that were copied from it.
/// A row that came again since it was damaged is none that is missing.
///
/// \param source  the damaged store.
/// \param target  has the rows that could be copied, and no others yet.
std::vector<Repaired::Table> account_of_rows(Database& source, Database& target);

}  // namespace kinship::store
