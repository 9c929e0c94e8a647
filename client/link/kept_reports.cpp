#include "client/link/kept_reports.hpp"

#include "proto/types/failure.hpp"

namespace kinship::link {

Result<Resend> parse_resend(std::string_view word) {
  if (word.empty())
    return Resend::Unacknowledged;
  if (word == "all")
    return Resend::All;
  if (word == "none")
    return Resend::None;
  return invalid_input("resend '" + std::string(word) + "' is neither 'all' nor 'none'");
}

std::string describe(const std::vector<KeptReports>& kept) {
  std::size_t reports = 0;
  std::string stores;
  for (const KeptReports& each : kept) {
    reports += each.reports;
    stores += (stores.empty() ? "" : ", ") + each.store;
  }
  if (reports == 0)
    return "";
  return std::to_string(reports) + (reports == 1 ? " report" : " reports") + " of " +
         (kept.size() == 1 ? "an older store (" : "older stores (") + stores + ") " +
         (reports == 1 ? "is" : "are") +
         " kept: 'kinship outbox resend --all' or --resend all sends them to the store that is "
         "there "
         "now, 'kinship outbox drop --all' deletes them";
}

}  // namespace kinship::link
