#pragma once

#include <optional>
#include <string>

namespace CLI {  // NOLINT: theirs
class App;
}

namespace kinship::app {

/// Source and destination of a move of a store, or the move to give up.
struct MigrateStoreOptions {
  std::string from = {}, to = {};  ///< as --store names stores
  bool give_up = false;
};

/// Adds `migrate-store`, which fills `options` where it was called.
void add_migrate_store(CLI::App& app, std::optional<MigrateStoreOptions>& options);

}  // namespace kinship::app
