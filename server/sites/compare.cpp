#include "server/sites/compare.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace kinship::sites {
namespace {

/// Calls `use` with each report of `from` and what `to` has of it: null, or its digest, which is
/// missing if it is damaged.
void for_each_report(
    store::ReportDigests& from, store::ReportDigests& to,
    const std::function<void(const store::ArrivedReport&, const std::optional<Digest>*)>& use) {
  constexpr std::size_t kReports = 256;
  store::Feed<store::ArrivedReport> feed;
  do {
    feed = from.list_arrivals(feed.cursor, kReports);
    std::vector<Uuid> reports;
    for (const store::ArrivedReport& report : feed.rows)
      reports.push_back(report.report_uuid);
    const std::map<Uuid, std::optional<Digest>> known = to.known_reports(reports);
    for (const store::ArrivedReport& report : feed.rows) {
      const auto there = known.find(report.report_uuid);
      use(report, there == known.end() ? nullptr : &there->second);
    }
  } while (feed.has_more);
}

}  // namespace

Comparison compare(store::ReportDigests& site, store::ReportDigests& memory,
                   const std::function<void(const Uuid& report, Difference)>& tell) {
  Comparison comparison;
  const auto count = [&](std::uint64_t& counter, const Uuid& report, Difference difference) {
    ++counter;
    tell(report, difference);
  };
  for_each_report(site, memory, [&](const auto& report, const std::optional<Digest>* above) {
    if (above == nullptr)
      count(comparison.of_site_alone, report.report_uuid, Difference::NotInMemory);
    else if (!*above)
      count(comparison.damaged, report.report_uuid, Difference::DamagedInMemory);
    else if (**above != report.body)
      count(comparison.differing, report.report_uuid, Difference::TwoContents);
    else
      ++comparison.same;
  });
  for_each_report(memory, site, [&](const auto& report, const std::optional<Digest>* below) {
    if (below == nullptr)
      ++comparison.of_memory_alone;
    else if (!*below)
      count(comparison.damaged, report.report_uuid, Difference::DamagedAtSite);
  });
  return comparison;
}

}  // namespace kinship::sites
