#include "server/app/check_sites_options.hpp"

#include <CLI/CLI.hpp>
#include <memory>

namespace kinship::app {
namespace {

constexpr const char* kCheckSitesFooter =
    R"(Neither store is changed, and servers may have them open. Both need the schema of this kinshipd.
Exit codes: 0 no report differs, 1 some do or are damaged, or failed, 2 wrong usage, 3 no such store.

Example:
  kinshipd sites check --site backup-of-ulm.db --memory 'postgresql://kinship@db1,db2/fleet')";

}  // namespace

void add_check_sites(CLI::App& app, std::optional<CheckSitesOptions>& options) {
  CLI::App* const sites =
      app.add_subcommand("sites", "A site and the memory above it")->configurable(false);
  sites->require_subcommand(1);
  CLI::App* const command = sites->add_subcommand(
      "check", "Compare the reports of a site with those of the memory above it, by their digests");
  command->footer(kCheckSitesFooter);
  const auto filled = std::make_shared<CheckSitesOptions>();
  command->add_option("--site", filled->site, "Store of the site")
      ->type_name("FILE|URL")
      ->required();
  command->add_option("--memory", filled->memory, "Store of the memory (--upstream of the site)")
      ->type_name("FILE|URL")
      ->required();
  command->callback([&options, filled] { options = *filled; });
}

}  // namespace kinship::app
