#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/store_check.hpp"
#include "proto/types/uuid.hpp"

/// Maintenance of a store that no server has open. Each function takes the store's lock.
/// \throws Failure(NotFound) if the file is missing, Failure(Unavailable) naming the process if a
///         server has the store open, Failure(Storage). All name the file.
namespace kinship::store {

using Progress = std::function<void(double)>;  ///< called now and then with 0 to 1

/// Reads SQLite's structure, every row and every blob, and compares the counts; writes nothing (but
/// rolls back a migration that was killed halfway).
/// \throws Failure(Storage) if the file is no store that this binary knows; the result reports
///         damage.
StoreCheck check_store(const std::filesystem::path& file, const Progress& progress);

/// Copies a store into a new file, which gets its name once it is complete.
/// \return the size of the copy, bytes. \throws Failure(Conflict) if `copy` exists.
std::uint64_t backup_store(const std::filesystem::path& file, const std::filesystem::path& copy,
                           const Progress& progress);

struct Restored {
  Uuid epoch;                      ///< new: clients offer again reports that the backup may lack
  std::filesystem::path replaced;  ///< where the old store is now; empty if there was none
  std::vector<std::filesystem::path> leftovers;  ///< files of earlier restores, the old stores too
};

/// Replaces a store, or makes one, by a copy of a backup. The whole copy is checked before; a
/// backup with a problem is refused and nothing is changed. The old store is kept as
/// FILE.replaced-YYYYMMDDTHHMMSSZ. At every instant the name leads to one whole store, the old or
/// the new one. An older backup is migrated.
Restored restore_store(const std::filesystem::path& backup, const std::filesystem::path& file,
                       const Progress& progress);

struct Repaired {
  /// Rows that are gone, or are without content until a client sends it again.
  struct Lost {
    std::string table;
    std::string robot;  ///< label; empty: none, or unknown
    std::string task;
    std::uint64_t rows = 0;
  };
  /// The rows of a table that are copied one by one.
  struct Table {
    struct Missing {
      std::int64_t id = 0;
      std::optional<Uuid> report = {};  ///< of an attempt, if an index still has it
    };
    std::string name;
    std::uint64_t before = 0;      ///< in the damaged store, by its indexes and its rows
    bool is_before_known = true;   ///< else `before` is what could be read of these
    std::uint64_t after = 0;       ///< copied
    std::uint64_t again = 0;       ///< damaged, but sent again since: not missing
    std::vector<Missing> missing;  ///< all of them
  };
  Restored restored;
  std::vector<Table> tables;
  /// Rows whose checksum was wrong, and stretches of rows, or the schema, that could not be read.
  std::uint64_t damaged_places = 0;
  std::vector<Lost> lost;
  StoreCheck check;  ///< of the new store; robots that lost their row are problems
};

/// Replaces a damaged store by a new one with all rows that can be read of it, under a new epoch,
/// so that clients offer their reports again. The damaged store is kept as by restore_store().
Repaired repair_store(const std::filesystem::path& file, const Progress& progress);

struct Migrated {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::filesystem::path backup;  ///< of the store before; empty if there was nothing to do
};

/// Brings a store to the newest schema, as a server does when it opens one.
Migrated migrate_store(const std::filesystem::path& file);

}  // namespace kinship::store
