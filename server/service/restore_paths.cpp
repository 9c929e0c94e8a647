#include "server/service/restore_paths.hpp"

#include <algorithm>
#include <array>
#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/sha256.hpp"

namespace kinship::service {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20U;  // of one report with its scene

std::optional<store::ReplicatedReport> read_report(const store::Store& store, const Uuid& report) {
  store::ReplicatedReports read = store.read_reports(std::array{report}, kMaxBytes);
  if (read.reports.empty())
    return std::nullopt;
  return std::move(read.reports.front());
}

Attempt copy_of(Attempt attempt, const Uuid& report) {
  PlanningRecord& record = attempt.record;
  record.planner_options =
      cut_text("restored=" + attempt.report_uuid.text() +
                   (record.planner_options.empty() ? "" : " " + record.planner_options),
               kMaxPlannerOptionsBytes);
  record.sampling_mode = SamplingMode::Uniform;
  record.share = 0;
  record.distribution_id.reset();
  record.distribution_revision = 0;
  attempt.report_uuid = report;
  attempt.search.reset();
  return attempt;
}

Receipt commit(store::Store& store, Attempt attempt) {
  const auto promise = std::make_shared<std::promise<Receipt>>();
  std::future<Receipt> receipt = promise->get_future();
  std::vector<Attempt> attempts;
  attempts.push_back(std::move(attempt));
  store.commit_reports(std::move(attempts), [promise](const std::vector<Receipt>& receipts) {
    promise->set_value(receipts.at(0));
  });
  return receipt.get();
}

void leave_out(std::uint64_t& count, const Uuid& report, const std::string& why,
               Restoration& restored) {
  ++count;
  restored.reason = cut_text("path " + report.text() + ": " + why, kMaxMessageBytes);
}

void restore_path(store::Store& store, const Uuid& report, Restoration& restored) {
  std::optional<store::ReplicatedReport> retired = read_report(store, report);
  if (!retired || !retired->attempt.path)
    return leave_out(restored.lost, report,
                     store.known_reports(std::array{report}).empty()
                         ? "no such report"
                         : "it brought no path, its waypoints were not kept, or its robot was "
                           "removed",
                     restored);
  // A restored path may have been retired, too.
  Uuid next = report;
  while (retired && retired->is_retired) {
    next = restored_report(next);
    if (store.known_reports(std::array{next}).empty())
      break;
    retired = read_report(store, next);
  }
  if (!retired)
    return leave_out(restored.lost, next, "cannot be read", restored);
  if (!retired->is_retired)
    return leave_out(restored.in_use, next, "is in use", restored);
  const Receipt receipt = commit(store, copy_of(std::move(retired->attempt), next));
  switch (receipt.status) {
    case ReceiptStatus::Stored:
      ++restored.paths;
      if (restored.report_uuid == Uuid())
        restored.report_uuid = next;
      return;
    case ReceiptStatus::Duplicate:
      return leave_out(restored.in_use, report, "another report has the same path, in use",
                       restored);
    case ReceiptStatus::TryAgain:
      if (const std::optional<std::string> why = store.why_put_off(next))
        return leave_out(restored.lost, report, *why, restored);
      throw Failure(ErrorCode::Unavailable,
                    "path " + report.text() + ": not stored now: " + receipt.message + "; " +
                        std::to_string(restored.paths) + " were restored; ask again for the rest");
    default:
      return leave_out(restored.lost, report, receipt.message, restored);
  }
}

}  // namespace

Uuid restored_report(const Uuid& retired) {
  const Digest digest = Sha256()
                            .add(std::string_view("kinship: restored path"))
                            .add(std::span<const std::uint8_t>(retired.bytes))
                            .finish();
  Uuid report;
  std::copy_n(digest.bytes.begin(), report.bytes.size(), report.bytes.begin());
  report.bytes[6] = static_cast<std::uint8_t>((report.bytes[6] & 0x0FU) | 0x80U);  // version 8
  report.bytes[8] = static_cast<std::uint8_t>((report.bytes[8] & 0x3FU) | 0x80U);
  return report;
}

void restore_paths(store::Store& store, std::span<const Uuid> reports, Restoration& restored) {
  for (const Uuid& report : reports)
    restore_path(store, report, restored);
}

}  // namespace kinship::service
