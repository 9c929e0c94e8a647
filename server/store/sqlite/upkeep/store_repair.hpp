#pragma once

#include <filesystem>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// The result of a salvage from a damaged store.
struct Salvaged {
  Uuid epoch;                        ///< of the damaged store; zeros: it cannot be read
  std::uint64_t damaged_places = 0;  ///< as Repaired has them
  std::vector<Repaired::Lost> lost;
  std::vector<Repaired::Table> tables;
};

/// Writes into a new store every row that SQL can read of a damaged one and whose checksum is
/// right. Where a page cannot be read, the rows behind it are searched by their ids. A damaged
/// schema is read as that of the new store, which lies at the same places. Counts and sums are
/// computed again; of distributions only the revisions are kept, they are fitted again, and
/// rehearsals are made again. A lost row that others refer to becomes a quarantined row without
/// content until a client sends it again: a robot at its registration, a path or a scene with a
/// report.
///
/// \param file         may be damaged anywhere; its WAL is not read.
/// \param target       an empty store of today's schema, in `target_file`.
Salvaged salvage(const std::filesystem::path& file, Database& target,
                 const std::filesystem::path& target_file, const Progress& progress);

}  // namespace kinship::store
