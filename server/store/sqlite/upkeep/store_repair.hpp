#pragma once

#include <filesystem>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// The result of a salvage from a damaged store.
struct Salvaged {
  std::uint64_t damaged_pages = 0;
  std::vector<Repaired::Lost> lost;
};

/// Writes all that can be read of a damaged store into a new one: every row of every sound page of
/// a table, even if its parent pages are damaged. Indexes, counts and sums are computed again; of
/// distributions only the revisions are kept, they are fitted again. A lost row that others refer
/// to becomes a quarantined row without content until a client sends it again: a robot at its
/// registration, a path or a scene with a report.
///
/// \param source  may be damaged anywhere.
/// \param target  an empty store of today's schema.
/// \throws Failure(Storage) if the source has no checksums, so that damage cannot be found.
Salvaged salvage(Database& source, Database& target, const Progress& progress);

}  // namespace kinship::store
