#include "server/app/check_sites.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <ostream>

#include "proto/types/exit_code.hpp"
#include "proto/types/failure.hpp"
#include "server/sites/compare.hpp"
#include "server/store/report_digests.hpp"

namespace kinship::app {
namespace {

constexpr const char* kCheckSitesFooter =
    R"(Neither store is changed, and servers may have them open. Both need the schema of this kinshipd.
Exit codes: 0 no report differs, 1 some do or are damaged, or failed, 2 wrong usage, 3 no such store.

Example:
  kinshipd sites check --site backup-of-ulm.db --memory 'postgresql://kinship@db1,db2/fleet')";

const char* text_of(sites::Difference difference) {
  switch (difference) {
    case sites::Difference::NotInMemory:
      return "not in the memory";
    case sites::Difference::TwoContents:
      return "one UUID, two contents";
    case sites::Difference::DamagedInMemory:
      return "damaged in the memory";
    case sites::Difference::DamagedAtSite:
      break;
  }
  return "damaged at the site";
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
    const auto site = store::open_report_digests(options.site);
    const auto memory = store::open_report_digests(options.memory);
    const sites::Comparison found =
        sites::compare(*site, *memory, [&out](const Uuid& report, sites::Difference difference) {
          out << "report " << report.text() << ": " << text_of(difference) << '\n';
        });
    out << "the same: " << found.same << "; at the site alone: " << found.of_site_alone
        << "; in the memory alone: " << found.of_memory_alone << "; different: " << found.differing
        << "; damaged: " << found.damaged << '\n';
    return found.differing + found.damaged == 0 ? kDone : kFailed;
  } catch (const Failure& failure) {
    err << "kinshipd: " << failure.what() << '\n';
    // Code 4 speaks of servers that answer.
    return failure.code() == ErrorCode::Unavailable ? kFailed : exit_code(failure.code());
  }
}

}  // namespace kinship::app
