#pragma once

#include <filesystem>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// What a store that is written anew got from a damaged one.
struct Salvaged {
  std::uint64_t damaged_pages = 0;
  std::vector<Repaired::Lost> lost;
};

/// Writes all that can be read of a damaged store into a new one: every row of every page of a
/// table that is sound, whatever became of the pages that lead there. Indexes, counts and sums are
/// made anew; distributions leave their revisions alone, they are fitted again. What rows refer to
/// and is lost stands there as a row without content, set aside, until its owner brings it again: a
/// robot at its registration, a path or a scene with a report.
///
/// \param source  may be damaged wherever it is.
/// \param target  an empty store of today's schema.
/// \throws Failure(Storage) if the source has no checksums, so that nobody knows what is damaged.
Salvaged salvage(Database& source, Database& target, const Progress& progress);

}  // namespace kinship::store
