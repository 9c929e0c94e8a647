#include "server/sites/carry.hpp"

#include <algorithm>
#include <chrono>
#include <future>
#include <map>
#include <memory>

#include "server/sites/carry_robot.hpp"

namespace kinship::sites {
namespace {

using store::ReplicatedReport;

void throw_if_stopped(const Way& way) {
  if (way.stop.stop_requested())
    throw Failure(ErrorCode::Unavailable, "the server is stopping");
}

/// The receipts of a commit. A store may take as long as it likes: a stop does not wait.
std::vector<Receipt> commit(const Way& way, std::vector<ReplicatedReport> reports) {
  if (reports.empty())
    return {};
  way.before_write();
  throw_if_stopped(way);
  // Shared with the callback, which may come after the wait has ended.
  const auto promise = std::make_shared<std::promise<std::vector<Receipt>>>();
  std::future<std::vector<Receipt>> receipts = promise->get_future();
  const auto done = [promise](const std::vector<Receipt>& answered) {
    promise->set_value(answered);
  };
  if (way.commit)
    way.commit(std::move(reports), done);
  else
    way.to.commit_replicated(std::move(reports), done);
  constexpr std::chrono::milliseconds kLook{50};
  while (receipts.wait_for(kLook) != std::future_status::ready)
    throw_if_stopped(way);
  return receipts.get();
}

/// The reports whose robots are at the other store by now; the others are refused.
std::vector<ReplicatedReport> with_robots(const Way& way, std::vector<ReplicatedReport> reports,
                                          CarriedReports& carried) {
  std::map<Digest, std::optional<Error>> robots;
  std::vector<ReplicatedReport> good;
  for (ReplicatedReport& report : reports) {
    const auto [robot, is_new] = robots.try_emplace(report.attempt.robot);
    if (is_new)
      robot->second = way.bring_robot ? way.bring_robot(report.attempt.robot)
                                      : carry_robot(way.from, way.to, report.attempt.robot);
    std::optional<Error> fault = robot->second;
    if (!fault && way.check)
      fault = way.check(report.attempt);
    if (fault && fault->code == ErrorCode::Storage)
      throw Failure(*fault);  // it may pass
    if (fault)
      carried.refused.push_back({report.attempt.report_uuid, fault->message});
    else
      good.push_back(std::move(report));
  }
  return good;
}

/// What the other store puts off alone counts as refused, so that nothing waits behind it.
void count(const Way& way, const std::vector<Receipt>& receipts, CarriedReports& carried) {
  for (const Receipt& receipt : receipts)
    switch (receipt.status) {
      case ReceiptStatus::TryAgain:
        if (const std::optional<std::string> why = way.to.why_put_off(receipt.report_uuid)) {
          carried.refused.push_back({receipt.report_uuid, *why, true});
          break;
        }
        [[fallthrough]];
      case ReceiptStatus::UnknownRobot:  // removed since it was registered
        throw Failure(ErrorCode::Unavailable,
                      "report " + receipt.report_uuid.text() + ": " + receipt.message);
      case ReceiptStatus::Refused:
        carried.refused.push_back({receipt.report_uuid, receipt.message});
        break;
      default:
        ++carried.new_there;
    }
}

void retire(const Way& way, std::span<const Uuid> reports) {
  if (reports.empty())
    return;
  way.before_write();
  throw_if_stopped(way);
  for (const Retirement& retirement :
       way.retire ? way.retire(reports) : way.to.retire_reports(reports))
    way.on_retired(retirement);
}

}  // namespace

std::uint64_t carry_retirements(const Way& way, std::string& cursor, const Piece& piece) {
  std::uint64_t carried = 0;
  bool has_more = true;
  while (has_more) {
    throw_if_stopped(way);
    const store::Feed<Uuid> feed = way.from.list_retirements(cursor, piece.retirements);
    retire(way, feed.rows);
    carried += feed.rows.size();
    cursor = feed.cursor;
    has_more = feed.has_more;
  }
  return carried;
}

CarriedReports carry_reports(const Way& way, std::span<const Uuid> reports, std::string& retired,
                             const Piece& piece) {
  CarriedReports carried;
  while (!reports.empty()) {
    throw_if_stopped(way);
    store::ReplicatedReports read =
        way.from.read_reports(reports.first(std::min(reports.size(), piece.commit)), piece.bytes);
    // Only now: this includes all retirements from before any of these was listed.
    carry_retirements(way, retired, piece);
    carried.left_out += read.looked_at - read.reports.size();
    count(way, commit(way, with_robots(way, std::move(read.reports), carried)), carried);
    reports = reports.subspan(read.looked_at);
  }
  return carried;
}

CarriedPage carry_page(const Way& way, std::string_view task, const std::string& cursor,
                       std::string& retired, const Piece& piece) {
  const store::Feed<store::ArrivedReport> feed =
      way.from.list_arrivals(task, cursor, piece.reports);
  std::vector<Uuid> arrived, missing, retired_before;
  for (const store::ArrivedReport& report : feed.rows)
    arrived.push_back(report.report_uuid);
  const std::map<Uuid, Digest> known =
      arrived.empty() ? std::map<Uuid, Digest>() : way.to.known_reports(arrived);
  for (const store::ArrivedReport& report : feed.rows) {
    const auto there = known.find(report.report_uuid);
    if (there == known.end() || there->second != report.body)
      missing.push_back(report.report_uuid);  // another body: `to` says what it thinks of it
    else if (report.is_retired)  // perhaps its list of retirements lost that in a repair
      retired_before.push_back(report.report_uuid);
  }
  for (std::span<const Uuid> left = retired_before; !left.empty();) {
    const std::size_t next = std::min(left.size(), piece.retirements);
    retire(way, left.first(next));
    left = left.subspan(next);
  }
  CarriedPage page{carry_reports(way, missing, retired, piece), arrived.size(), feed.cursor,
                   feed.has_more};
  if (missing.empty())
    carry_retirements(way, retired, piece);
  return page;
}

}  // namespace kinship::sites
