#pragma once

#include <optional>
#include <string>

namespace CLI {  // NOLINT: theirs
class App;
}

namespace kinship::app {

/// The two stores that `kinshipd sites check` compares.
struct CheckSitesOptions {
  std::string site = {}, memory = {};  ///< as --store names stores
};

/// Adds `sites check`, which fills `options` where it was called.
void add_check_sites(CLI::App& app, std::optional<CheckSitesOptions>& options);

}  // namespace kinship::app
