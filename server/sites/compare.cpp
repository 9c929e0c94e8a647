#include "server/sites/compare.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace kinship::sites {
namespace {

/// Calls `use` with each report of `from` and its digest in `to`; none: it is not there.
void for_each_report(
    const store::ReplicationStore& from, const store::ReplicationStore& to,
    const std::function<void(const store::ArrivedReport&, const std::optional<Digest>&)>& use) {
  constexpr std::size_t kReports = 256;
  store::Feed<store::ArrivedReport> feed;
  do {
    feed = from.list_arrivals("", feed.cursor, kReports);
    std::vector<Uuid> reports;
    for (const store::ArrivedReport& report : feed.rows)
      reports.push_back(report.report_uuid);
    const std::map<Uuid, Digest> known = to.known_reports(reports);
    for (const store::ArrivedReport& report : feed.rows) {
      const auto there = known.find(report.report_uuid);
      use(report, there == known.end() ? std::nullopt : std::optional(there->second));
    }
  } while (feed.has_more);
}

}  // namespace

Comparison compare(const store::ReplicationStore& site, const store::ReplicationStore& memory,
                   const std::function<void(const Uuid& report, bool is_differing)>& tell) {
  Comparison comparison;
  for_each_report(site, memory, [&](const auto& report, const std::optional<Digest>& above) {
    if (above == report.body) {
      ++comparison.same;
      return;
    }
    ++(above ? comparison.differing : comparison.of_site_alone);
    tell(report.report_uuid, above.has_value());
  });
  for_each_report(memory, site, [&](const auto&, const std::optional<Digest>& below) {
    if (!below)
      ++comparison.of_memory_alone;
  });
  return comparison;
}

}  // namespace kinship::sites
