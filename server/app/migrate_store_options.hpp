#pragma once

#include <optional>
#include <string>

namespace CLI {  // NOLINT: theirs
class App;
}

namespace kinship::app {

/// Which store is to be brought where, or which move is to be ended.
struct MigrateStoreOptions {
  std::string from = {}, to = {};  ///< as --store names stores
  bool give_up = false;
};

/// Adds `migrate-store`, which fills `options` where it was called.
void add_migrate_store(CLI::App& app, std::optional<MigrateStoreOptions>& options);

}  // namespace kinship::app
