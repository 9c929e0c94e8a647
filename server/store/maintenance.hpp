#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "proto/types/store_check.hpp"
#include "proto/types/uuid.hpp"

/// What is done to a store that no server has open. Each takes the store's lock.
/// \throws Failure(NotFound) if the file is missing, Failure(Unavailable) naming the process if a
///         server has the store open, Failure(Storage). All name the file.
namespace kinship::store {

using Progress = std::function<void(double)>;  ///< called now and then with 0 to 1

/// Reads every page, every row and every blob, and compares the counts; writes nothing (but rolls
/// back what a killed migration left half done).
/// \throws Failure(Storage) if it is no store that this binary knows; damage is in the result.
StoreCheck check_store(const std::filesystem::path& file, const Progress& progress);

/// Copies a store into a new file, which has its name once it is complete.
/// \return its bytes. \throws Failure(Conflict) if `copy` is there already.
std::uint64_t backup_store(const std::filesystem::path& file, const std::filesystem::path& copy,
                           const Progress& progress);

struct Restored {
  Uuid epoch;                      ///< a new one: clients offer again what the backup may lack
  std::filesystem::path replaced;  ///< where the old store is now; empty if there was none
  std::vector<std::filesystem::path> leftovers;  ///< of earlier restores, the old stores too
};

/// Puts a copy of a backup in the place of a store, or where there is none. The copy is checked
/// wholly before; a backup with a problem is refused and nothing is changed. The old store is kept
/// as FILE.replaced-YYYYMMDDTHHMMSSZ. At every instant there is one whole store under the name, the
/// old one or the new one. An older backup is migrated.
Restored restore_store(const std::filesystem::path& backup, const std::filesystem::path& file,
                       const Progress& progress);

struct Repaired {
  /// Rows that are gone, or stand without their content until their owners bring it again.
  struct Lost {
    std::string table;
    std::string robot;  ///< label; empty: of none, or unknown
    std::string task;
    std::uint64_t rows = 0;
  };
  Restored restored;
  std::uint64_t damaged_pages = 0;
  std::vector<Lost> lost;
  StoreCheck check;  ///< of the new store; robots that lost their row are problems
};

/// Puts a store made of all that can be read of a damaged one in its place, under a new epoch, so
/// that clients offer again what they have. The damaged store is kept as restore_store() does it.
/// \throws Failure(Storage) if its pages bear no checksums: it is no store.
Repaired repair_store(const std::filesystem::path& file, const Progress& progress);

struct Migrated {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::filesystem::path backup;  ///< of the store as it was; empty if there was nothing to do
};

/// Brings a store to the newest schema, as a server does when it opens one.
Migrated migrate_store(const std::filesystem::path& file);

}  // namespace kinship::store
