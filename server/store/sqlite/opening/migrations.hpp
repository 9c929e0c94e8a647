#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// One file of schema/sqlite.
struct Migration {
  std::int64_t version = 0;  ///< 1, 2, 3, ... without gaps
  std::string_view name;     ///< of the file, without ".sql"
  std::string_view text;
};

/// All migrations that this binary knows, by version (written by cmake/embed_texts.cmake).
std::span<const Migration> embedded_migrations();

/// The schema of a file that this binary can read or migrate; 0 if the file is empty.
/// \throws Failure(Storage) if the file is no Kinship store, is newer than
///         `migrations`, or was made by a migration of another text; SqliteError::is_damage() if
///         its schema is not as the migrations make it.
std::int64_t known_schema(Database& database, const std::filesystem::path& file,
                          std::span<const Migration> migrations);

enum class Keep {
  Copy,    ///< of a store that is migrated: FILE.backup-<version>
  Nothing  ///< the file is a copy itself
};

/// Opens a store, also a new one, for its only writer, and applies the missing ones of
/// `migrations`, each in one transaction. Each is recorded with the SHA-256 of its text, and in the
/// audit log unless the store is new.
///
/// \param file  may be empty.
/// \throws Failure(Storage) as known_schema() does; nothing is changed then.
std::unique_ptr<Database> open_migrated(const std::filesystem::path& file,
                                        std::span<const Migration> migrations,
                                        Keep keep = Keep::Copy);

/// The file of the copy of a database of this version, made before a migration. Only a complete
/// copy has that name.
std::filesystem::path backup_of_version(const std::filesystem::path& file, std::int64_t version);

/// Checks that a database is a Kinship store at the newest version, made by the same migrations.
/// \throws Failure(Storage) if not.
void check_schema(Database& database, const std::filesystem::path& file,
                  std::span<const Migration> migrations);

}  // namespace kinship::store
