#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/types/conversations.hpp"
#include "server/catalog/advice_cache.hpp"
#include "server/quotas/known_tasks.hpp"
#include "server/service/fetch_service.hpp"
#include "server/service/ingest.hpp"
#include "server/service/service_parts.hpp"
#include "server/service/upstream.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// Takes in reports, and tells the other services of new experience. May be shared between threads;
/// `done` as in Service.
class ReportService {
 public:
  /// \param store, fetches, upstream  outlive the service.
  ReportService(const ServiceParts& parts, store::Store& store, FetchService& fetches,
                Upstream& upstream);
  ReportService(const ReportService&) = delete;
  ReportService& operator=(const ReportService&) = delete;

  /// \param client  the caller; empty: no particular client, without a quota.
  void report(ReportRequest request, std::function<void(const ReportReply&)> done,
              const std::string& client = {});
  /// Commits checked reports of other sites; `done` as in ReplicationStore::commit_replicated.
  void commit_replicated(std::vector<store::ReplicatedReport> reports,
                         store::ReportStore::ReportsDone done);
  /// Makes reported attempts durable and answers them; later ones are to be sent again.
  void drain() { ingest_.drain(); }

  const Ingest& ingest() const noexcept { return ingest_; }
  /// Attempts refused before they reached ingest().
  std::uint64_t refused_before() const noexcept { return refused_before_; }

 private:
  Ingest::Options ingest_options();
  std::optional<quotas::Refusal> may_begin_task(const std::string& client, const std::string& task);
  void begin_epoch(const ConsistencyToken& lost);
  void take_in(ReportRequest request, std::function<void(const ReportReply&)> done,
               const std::string& client);
  void answered(std::span<const catalog::AttemptCost> costs, std::span<const Receipt> receipts);
  void note_replicated(std::span<const catalog::AttemptCost> costs,
                       std::span<const Receipt> receipts);
  void count_refused(const std::vector<Receipt>& receipts);

  const ServiceParts parts_;
  store::Store& store_;
  FetchService& fetches_;
  Upstream& upstream_;
  quotas::KnownTasks known_tasks_;
  std::atomic<std::uint64_t> refused_before_{0};
  Ingest ingest_;  // last: drains on destruction, and calls the above
};

}  // namespace kinship::service
