#include "server/service/report_service.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "server/service/publish_events.hpp"

namespace kinship::service {
namespace {

using quotas::Quota;
using runtime::Trouble;
using Priority = runtime::WorkerPool::Priority;

}  // namespace

ReportService::ReportService(const ServiceParts& parts, store::Store& store, FetchService& fetches,
                             Upstream& upstream)
    : parts_(parts),
      store_(store),
      fetches_(fetches),
      upstream_(upstream),
      ingest_(store, parts.robots, parts.pools.store, ingest_options()) {}

Ingest::Options ReportService::ingest_options() {
  Ingest::Options ingest;
  ingest.max_attempts = parts_.options.max_queued_attempts;
  ingest.client_attempts = parts_.options.client_attempts;
  ingest.on_over_quota = [this](const std::string& client, const std::string& message) {
    parts_.clients.count_refusal(client, Quota::Waiting);
    parts_.troubles.add(Trouble::ReportQuota, message);
  };
  ingest.is_known_task = [this](const std::string& task) { return known_tasks_.has(task); };
  ingest.may_begin_task = [this](const std::string& client, const std::string& task) {
    return may_begin_task(client, task);
  };
  ingest.on_kept = [this](const std::string& client, const std::string& task, std::size_t bytes) {
    if (known_tasks_.add(task))
      parts_.clients.count_task(client);
    parts_.clients.count_stored(client, bytes);
  };
  ingest.on_new_experience = [this](std::string_view task) { fetches_.new_experience(task); };
  ingest.on_answer = [this](std::span<const catalog::AttemptCost> costs,
                            std::span<const Receipt> receipts) { answered(costs, receipts); };
  return ingest;
}

std::optional<quotas::Refusal> ReportService::may_begin_task(const std::string& client,
                                                             const std::string& task) {
  if (store_.find_task(task)) {
    known_tasks_.add(task);
    return std::nullopt;
  }
  std::optional<quotas::Refusal> refusal = parts_.clients.may_add(client, Quota::Tasks);
  if (refusal)
    parts_.troubles.add(Trouble::ClientQuota, refusal->message);
  return refusal;
}

void ReportService::report(ReportRequest request, std::function<void(const ReportReply&)> done,
                           const std::string& client) {
  if (!store_.may_have_lost(request.known_token))
    return take_in(std::move(request), std::move(done), client);
  // No answer if it fails: a newer token in it would make the client forget the lost one.
  auto run = [this, request = std::move(request), done, client]() mutable {
    try {
      if (store_.has_lost(request.known_token))
        begin_epoch(request.known_token);
    } catch (const std::exception& exception) {
      return parts_.options.log(std::string("store: rolled back, no new epoch yet: ") +
                                exception.what());
    }
    take_in(std::move(request), std::move(done), client);
  };
  if (!parts_.pools.store.submit(Priority::Interactive,
                                 {.run = std::move(run), .abandon = {}, .client = client})) {
    if (parts_.pools.is_stopping())
      return;
    ReportReply busy;  // without the store's epoch and token: the client keeps those it has
    busy.message = "the server is busy";
    busy.retry_after = TaskPools::kRetryAfter;
    done(busy);
  }
}

void ReportService::begin_epoch(const ConsistencyToken& lost) {
  if (!store_.begin_epoch_if_lost(lost))
    return;  // another client was first
  parts_.tell({}, "the store was rolled back behind receipts of clients: epoch " +
                      store_.epoch().text() + " begins, they offer again what is missing");
}

void ReportService::take_in(ReportRequest request, std::function<void(const ReportReply&)> done,
                            const std::string& client) {
  refused_before_ += request.refused.size();
  publish_refused(parts_.events, request.refused);
  ingest_.submit(
      std::move(request.attempts),
      [this, refused = std::move(request.refused), done = std::move(done),
       began = parts_.options.clock.now()](const std::vector<Receipt>& receipts,
                                           RetryAfter retry_after) {
        store::StorePoint point = store_.point();
        ReportReply reply{point.epoch, receipts, std::move(point.token), retry_after};
        reply.receipts.insert(reply.receipts.end(), refused.begin(), refused.end());
        count_refused(reply.receipts);
        parts_.measures.count(reply.receipts, parts_.options.clock.now() - began);
        done(reply);
      },
      client);
}

void ReportService::answered(std::span<const catalog::AttemptCost> costs,
                             std::span<const Receipt> receipts) {
  for (std::size_t i = 0; i < std::min(costs.size(), receipts.size()); ++i)
    if (receipts[i].status == ReceiptStatus::Stored ||
        receipts[i].status == ReceiptStatus::Recorded)
      fetches_.add(costs[i]);
  publish_report(parts_.events, parts_.robots, costs, receipts);
  upstream_.wake();
}

void ReportService::commit_replicated(std::vector<store::ReplicatedReport> reports,
                                      store::ReportStore::ReportsDone done) {
  std::vector<catalog::AttemptCost> costs;
  costs.reserve(reports.size());
  for (const store::ReplicatedReport& report : reports)
    costs.push_back(catalog::cost_of(report.attempt));
  store_.commit_replicated(std::move(reports),
                           [this, costs = std::move(costs),
                            done = std::move(done)](const std::vector<Receipt>& receipts) {
                             note_replicated(costs, receipts);
                             done(receipts);
                           });
}

/// As reports of this site's robots, but without an event for each of them.
void ReportService::note_replicated(std::span<const catalog::AttemptCost> costs,
                                    std::span<const Receipt> receipts) {
  std::map<std::string, std::size_t> grown;  // paths
  for (std::size_t i = 0; i < std::min(costs.size(), receipts.size()); ++i) {
    const bool is_stored = receipts[i].status == ReceiptStatus::Stored;
    if (is_stored || receipts[i].status == ReceiptStatus::Recorded) {
      fetches_.add(costs[i]);
      known_tasks_.add(costs[i].task);
    }
    if (is_stored)
      ++grown[costs[i].task];
  }
  for (const auto& [task, paths] : grown) {
    fetches_.new_experience(task);
    parts_.events.tell(EventKind::Report, task, {}, [paths = paths] {
      return std::to_string(paths) + " paths of other sites came";
    });
  }
}

void ReportService::count_refused(const std::vector<Receipt>& receipts) {
  const auto count = [&](ReceiptStatus status, Trouble what, const std::string& words) {
    const auto is_one = [status](const Receipt& receipt) { return receipt.status == status; };
    const auto first = std::find_if(receipts.begin(), receipts.end(), is_one);
    if (first == receipts.end())
      return;
    const auto number = std::count_if(first, receipts.end(), is_one);
    parts_.troubles.add(what,
                        std::to_string(number) + " of " + std::to_string(receipts.size()) +
                            " attempts " + words + ", first: " + first->message,
                        static_cast<std::uint64_t>(number));
  };
  count(ReceiptStatus::Refused, Trouble::ReportRefused, "refused");
  count(ReceiptStatus::TryAgain, Trouble::ReportTryAgain, "to be sent again");
  count(ReceiptStatus::UnknownRobot, Trouble::ReportUnknown, "of robots that are not registered");
}

}  // namespace kinship::service
