#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/opening/migrations.hpp"

namespace kinship::store {

enum class Keep {
  Copy,    ///< of a store that is migrated: FILE.backup-<version>
  Nothing  ///< the file is a copy itself
};

/// Opens a store for the one who writes to it, a new one too, and brings it to today's schema. One
/// from before schema 4 is written anew on the way, with checksums at the end of its pages: its
/// copy has the name FILE.sealing until it is complete, and then takes the place of the old file,
/// which has a copy at FILE.backup-<version> by then.
///
/// \param file  may be empty.
/// \throws Failure(Storage) if the file is no Kinship store or newer than `migrations`; nothing is
///         changed then.
std::unique_ptr<Database> open_migrated(const std::filesystem::path& file,
                                        std::span<const Migration> migrations,
                                        Keep keep = Keep::Copy);

/// Writes all that a database holds into a file anew, sealed, as VACUUM does; it is not synced.
/// \param copy  an empty file; it keeps its mode.
void write_sealed_copy(Database& database, const std::filesystem::path& copy);

}  // namespace kinship::store
