#include "server/app/check_sites.hpp"

#include <ostream>

#include "proto/types/exit_code.hpp"
#include "proto/types/failure.hpp"
#include "server/sites/compare.hpp"
#include "server/store/report_digests.hpp"

namespace kinship::app {
namespace {

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
