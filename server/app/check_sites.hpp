#pragma once

#include <iosfwd>
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

/// Names the reports that a site and the memory above it do not have alike. Changes neither.
/// \return kDone: no UUID has two contents, none is damaged; kFailed; kWrongUsage; kNotFound.
int run_check_sites(const CheckSitesOptions& options, std::ostream& out, std::ostream& err);

}  // namespace kinship::app
