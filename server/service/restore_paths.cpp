#include "server/service/restore_paths.hpp"

#include <algorithm>
#include <array>
#include <future>
#include <map>
#include <memory>
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

constexpr std::size_t kMaxBytes = std::size_t{16} << 20U;  // of one batch, with scenes

std::optional<store::ReplicatedReport> read_report(const store::Store& store, const Uuid& report) {
  store::ReplicatedReports read = store.read_reports(std::array{report}, kMaxBytes);
  if (read.reports.empty())
    return std::nullopt;
  return std::move(read.reports.front());
}

/// A copy to be stored, and the report that it is of.
struct Copy {
  Uuid report;
  Attempt attempt;
};

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

std::vector<Receipt> commit(store::Store& store, std::vector<Copy>& copies) {
  if (copies.empty())
    return {};
  const auto promise = std::make_shared<std::promise<std::vector<Receipt>>>();
  std::future<std::vector<Receipt>> receipts = promise->get_future();
  std::vector<Attempt> attempts;
  for (Copy& copy : copies)
    attempts.push_back(std::move(copy.attempt));
  store.commit_reports(std::move(attempts), [promise](const std::vector<Receipt>& answered) {
    promise->set_value(answered);
  });
  return receipts.get();
}

void leave_out(std::uint64_t& count, const Uuid& report, const std::string& why,
               Restoration& restored) {
  ++count;
  restored.reason = cut_text("path " + report.text() + ": " + why, kMaxMessageBytes);
}

/// The copy of a retired report, or of its last copy, which may have been retired, too. Nothing: it
/// is left out.
std::optional<Copy> make_copy(const store::Store& store, const Uuid& report,
                              std::optional<store::ReplicatedReport> retired,
                              Restoration& restored) {
  if (!retired || !retired->attempt.path) {
    leave_out(restored.lost, report,
              store.known_reports(std::array{report}).empty()
                  ? "no such report"
                  : "it brought no path, its waypoints were not kept, or its robot was removed",
              restored);
    return std::nullopt;
  }
  Uuid next = report;
  while (retired && retired->is_retired) {
    next = restored_report(next);
    if (store.known_reports(std::array{next}).empty())
      break;
    retired = read_report(store, next);
  }
  if (retired && retired->is_retired)
    return Copy{report, copy_of(std::move(retired->attempt), next)};
  leave_out(retired ? restored.in_use : restored.lost, next,
            retired ? "is in use" : "cannot be read", restored);
  return std::nullopt;
}

void count(const Copy& copy, const Receipt& receipt, Restoration& restored) {
  if (receipt.status == ReceiptStatus::Duplicate)
    return leave_out(restored.in_use, copy.report, "another report has the same path, in use",
                     restored);
  if (receipt.status != ReceiptStatus::Stored)
    return leave_out(restored.lost, copy.report, receipt.message, restored);
  ++restored.paths;
  if (restored.report_uuid == Uuid())
    restored.report_uuid = receipt.report_uuid;
}

/// Stores all copies at once.
void store_copies(store::Store& store, std::vector<Copy> copies, Restoration& restored) {
  const std::vector<Receipt> receipts = commit(store, copies);
  std::optional<std::string> later;
  for (std::size_t i = 0; i < copies.size(); ++i) {
    Receipt receipt = receipts.at(i);
    if (receipt.status == ReceiptStatus::TryAgain) {
      const std::optional<std::string> why = store.why_put_off(receipt.report_uuid);
      if (!why) {
        later = "path " + copies[i].report.text() + ": not stored now: " + receipt.message;
        continue;
      }
      receipt.message = *why;
    }
    count(copies[i], receipt, restored);
  }
  if (later)
    throw Failure(ErrorCode::Unavailable, *later + "; " + std::to_string(restored.paths) +
                                              " were restored; ask again for the rest");
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

void restore_paths(store::Store& store, std::span<const Uuid> reports, const std::stop_token& stop,
                   Restoration& restored) {
  while (!reports.empty()) {
    if (stop.stop_requested())
      throw Failure(ErrorCode::Unavailable, "the server is stopping after " +
                                                std::to_string(restored.paths) +
                                                " paths were restored; ask again for the rest");
    store::ReplicatedReports read = store.read_reports(
        reports.first(std::min(reports.size(), kMaxAttemptsPerBatch)), kMaxBytes);
    std::map<Uuid, store::ReplicatedReport> found;
    for (store::ReplicatedReport& report : read.reports)
      found.emplace(report.attempt.report_uuid, std::move(report));
    std::vector<Copy> copies;
    for (const Uuid& report : reports.first(read.looked_at)) {
      std::optional<store::ReplicatedReport> retired;
      if (auto node = found.extract(report))
        retired = std::move(node.mapped());
      if (auto copy = make_copy(store, report, std::move(retired), restored))
        copies.push_back(*std::move(copy));
    }
    store_copies(store, std::move(copies), restored);
    reports = reports.subspan(read.looked_at);
  }
}

}  // namespace kinship::service
