#include "server/app/check_sites.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <ostream>

#include "proto/types/exit_code.hpp"
#include "proto/types/failure.hpp"
#include "server/sites/compare.hpp"
#include "server/store/open_store.hpp"

namespace kinship::app {
namespace {

constexpr const char* kCheckSitesFooter =
    R"(An SQLite store must not be served meanwhile: name a backup of it ('kinship backup'). A database may be.
Exit codes: 0 no report differs, 1 some do, or failed, 2 wrong usage, 3 no such store.

Example:
  kinshipd sites check --site backup-of-ulm.db --memory 'postgresql://kinship@db1,db2/fleet')";

/// \throws Failure(NotFound) rather than making a store.
std::unique_ptr<store::Store> open_existing(const std::string& name) {
  if (store::kind_of_store(name).value_or_throw() == store::StoreKind::SqliteFile &&
      !std::filesystem::exists(name))
    throw Failure(ErrorCode::NotFound, "store '" + name + "': there is none");
  return store::open_store(name, {});
}

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

int run_check_sites(const CheckSitesOptions& options, std::ostream& out, std::ostream& err) {
  try {
    const std::unique_ptr<store::Store> site = open_existing(options.site);
    const std::unique_ptr<store::Store> memory = open_existing(options.memory);
    const sites::Comparison found =
        sites::compare(*site, *memory, [&out](const Uuid& report, bool is_differing) {
          out << "report " << report.text()
              << (is_differing ? ": one UUID, two contents\n" : ": not in the memory\n");
        });
    out << "the same: " << found.same << "; at the site alone: " << found.of_site_alone
        << "; in the memory alone: " << found.of_memory_alone << "; different: " << found.differing
        << '\n';
    return found.differing == 0 ? kDone : kFailed;
  } catch (const Failure& failure) {
    err << "kinshipd: " << failure.what() << '\n';
    // A server that has a store open is a failure here; code 4 speaks of servers that answer.
    return failure.code() == ErrorCode::Unavailable ? kFailed : exit_code(failure.code());
  }
}

}  // namespace kinship::app
