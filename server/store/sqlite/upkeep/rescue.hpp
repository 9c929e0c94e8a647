#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/files/named_store.hpp"
#include "server/store/sqlite/files/wal_frames.hpp"

namespace kinship::store {

/// A store whose names, or whose content, are not what was written.
struct LostStore {
  std::filesystem::path file;
  const NamedStore& named;
  StoreChange change;
  std::optional<WalIndex> index;  ///< when it was lost
  std::uint64_t attempts;         ///< that were acknowledged
};

struct Rescue {
  bool is_saved = false;    ///< nothing is left to be saved from the connection
  bool is_in_file = false;  ///< the store's file itself has all
  std::string text;         ///< what was saved, and what to do
};

/// Saves what the connection of a lost store still reads: in the file itself, if that is sound and
/// has a name, else as FILE.rescued-<time> beside the store, or above its folder. It may take long.
Rescue rescue(Database& lost, const LostStore& store);

}  // namespace kinship::store
