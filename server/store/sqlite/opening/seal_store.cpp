#include "server/store/sqlite/opening/seal_store.hpp"

#include <sqlite3.h>

#include <array>
#include <string>
#include <string_view>

#include "server/store/sqlite/database/checked_vfs.hpp"
#include "server/store/sqlite/database/page_seal.hpp"
#include "server/store/sqlite/files/new_file.hpp"
#include "server/store/sqlite/files/store_file.hpp"

namespace kinship::store {
namespace {

namespace fs = std::filesystem;

/// The name of a file for SQLite, which shall be sealed.
std::string uri_of_sealed(const fs::path& file) {
  std::string uri = "file:";
  for (const char letter : file.string()) {
    constexpr std::string_view kSpecial = "%?#";
    constexpr std::string_view kDigits = "0123456789abcdef";
    if (kSpecial.find(letter) == std::string_view::npos) {
      uri += letter;
      continue;
    }
    const auto byte = static_cast<unsigned char>(letter);
    uri += {'%', kDigits[byte >> 4U], kDigits[byte & 0xFU]};
  }
  return uri + "?sealed=1";
}

/// Writes the file anew with room for a seal on each page. At every instant there is one whole
/// store under its name.
void seal(std::unique_ptr<Database> database, const fs::path& file) {
  const fs::path copy = file.string() + ".sealing";
  for (const std::string companion : {"", "-wal", "-shm", "-journal"})
    fs::remove(copy.string() + companion);
  make_for_owner(copy);
  fs::permissions(copy, fs::status(file).permissions());
  database->execute("PRAGMA journal_mode = DELETE");  // no WAL may lie beside another file
  write_sealed_copy(*database, copy);
  database.reset();
  sync_file(copy);
  fs::rename(copy, file);
  sync_directory_of(file);
}

}  // namespace

void write_sealed_copy(Database& database, const fs::path& copy) {
  int reserve = static_cast<int>(kSealBytes);
  sqlite3_file_control(&database.connection(), "main", SQLITE_FCNTL_RESERVE_BYTES, &reserve);
  Statement(database.connection(), "VACUUM INTO ?")
      .bind(1, std::string_view(uri_of_sealed(copy)))
      .run();
}

std::unique_ptr<Database> open_migrated(const fs::path& file, std::span<const Migration> migrations,
                                        Keep keep) {
  auto database = std::make_unique<Database>(file, Access::ReadWrite);
  const std::int64_t version = known_schema(*database, file, migrations);
  if (keep == Keep::Copy && version > 0 && version < std::ssize(migrations))
    keep_copy_of(*database, file, version);
  if (!is_sealed(database->connection())) {
    seal(std::move(database), file);
    database = std::make_unique<Database>(file, Access::ReadWrite);
  }
  // The size of pages counts for a new file only.
  database->execute("PRAGMA page_size = 4096; PRAGMA foreign_keys = ON; PRAGMA synchronous = FULL");
  // A rollback journal does not keep what free pages held: a cut in the middle would leave them
  // torn, with checksums that are wrong.
  if (keep == Keep::Copy)
    database->execute("PRAGMA journal_mode = WAL");
  apply_missing(*database, file, migrations);
  return database;
}

}  // namespace kinship::store
