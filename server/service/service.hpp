#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/summaries.hpp"
#include "server/metrics/exposition.hpp"
#include "server/service/admin_service.hpp"
#include "server/service/fetch_service.hpp"
#include "server/service/registration_service.hpp"
#include "server/service/report_service.hpp"
#include "server/service/service_options.hpp"
#include "server/service/service_parts.hpp"
#include "server/service/store_status_reader.hpp"
#include "server/service/store_watch.hpp"
#include "server/service/task_pools.hpp"
#include "server/service/upstream.hpp"

namespace kinship::service {

/// Composes the use cases of kinshipd: register, report, fetch, administer. Knows neither DDS nor
/// SQL. May be shared between threads.
///
/// Every `done` of a service is called at most once, on any thread, also during the call itself; it
/// must not throw or block. None is called after shutdown() has returned.
class Service {
 public:
  using TimePoint = FetchService::TimePoint;

  Service(std::unique_ptr<store::Store> store, ServiceOptions options);
  ~Service();  ///< shutdown()
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  RegistrationService& registration() noexcept { return registration_; }
  ReportService& reports() noexcept { return reports_; }
  FetchService& fetches() noexcept { return fetches_; }
  AdminService& administration() noexcept { return administration_; }

  /// Whether a client may send a request now, asked before the request is decoded; a refusal says
  /// when it may. Counts admitted requests.
  /// \param client  the caller; empty: no particular client, without a quota.
  /// \param bytes, attempts  of the request.
  std::optional<quotas::Refusal> admit(const std::string& client, std::size_t bytes,
                                       std::size_t attempts = 0);
  /// The same for a registration.
  std::optional<quotas::Refusal> admit_robot(const std::string& client, std::size_t bytes);
  /// Takes over what a caller says of itself, for `kinship status --clients`.
  void describe_client(const Caller& caller) {
    clients_.describe(caller.client, caller.host, caller.program);
  }

  /// For the wait loop: when to call expire().
  std::optional<TimePoint> next_deadline() const;
  void expire(TimePoint now);

  ServerStatus status() const;
  const Measures& measures() const noexcept { return measures_; }
  /// All metrics, for monitoring of many servers (service_metrics.cpp). Reads the store's status;
  /// if that fails, its families are left out and one family says so. Not for the thread that waits
  /// on the network.
  void expose(metrics::Exposition& page) const;

  /// Accepts no more requests, makes reported attempts durable and answers them, answers waiting
  /// fetches Busy, gives up fits and jobs, and returns when all of that is done. A second call
  /// returns at once. Not to be called from a `done`.
  void shutdown();

 private:
  ServiceParts parts();
  std::optional<quotas::Refusal> counted(std::optional<quotas::Refusal> refusal);
  void note_memory();
  std::vector<BoundUse> bounds(const store::StoreStatus& store) const;
  void expose_use(metrics::Exposition& page) const;
  void expose_guidance(metrics::Exposition& page) const;

  // Each member uses members above it, also on threads of its own, which shutdown() ends.
  const ServiceOptions options_;
  const TimePoint started_;
  const std::unique_ptr<store::Store> store_;
  mutable StoreStatusReader store_status_;
  runtime::ErrorCounters troubles_;
  Measures measures_;
  EventFeed events_;
  quotas::ClientQuotas clients_;
  runtime::RobotRegistry robots_;
  TaskPools pools_;
  Upstream upstream_;  // its thread also uses reports_ and fetches_, between start() and stop()
  FetchService fetches_;
  ReportService reports_;
  RegistrationService registration_;
  AdminService administration_;  // a job may ask for status()
  StoreWatch watch_;
};

}  // namespace kinship::service
