#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "server/catalog/advice_cache.hpp"
#include "server/catalog/catalog.hpp"
#include "server/catalog/experience_index.hpp"
#include "server/metrics/exposition.hpp"
#include "server/quotas/client_quotas.hpp"
#include "server/quotas/known_tasks.hpp"
#include "server/rehearsal/rehearsal_scheduler.hpp"
#include "server/runtime/clock.hpp"
#include "server/runtime/error_counters.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/runtime/worker_pool.hpp"
#include "server/service/administration.hpp"
#include "server/service/event_feed.hpp"
#include "server/service/ingest.hpp"
#include "server/service/jobs.hpp"
#include "server/service/measures.hpp"
#include "server/service/store_status_reader.hpp"
#include "server/service/store_watch.hpp"
#include "server/sites/forwarder.hpp"
#include "server/sites/used_tasks.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// The memory above a site.
struct UpstreamOptions {
  std::function<std::unique_ptr<store::Store>()> open;  ///< empty: there is none
  std::string name;                                     ///< for people, without passwords
  std::vector<std::string> tasks;  ///< patterns of tasks whose experience always comes down
};

struct ServiceOptions {
  std::string version;
  /// When the server's certificate ends, Unix time; 0: it has none.
  std::int64_t credentials_expire_ms = 0;
  std::size_t fit_threads = 1;
  std::size_t fit_memory_bytes = std::size_t{2048} << 20U;  ///< of all fits together, at most
  std::size_t fit_queue = 256;           ///< fits that wait; more are answered Busy
  int fit_niceness = 10;                 ///< so that planners on the same machine come first
  double rehearsal_fraction = 0.1;       ///< see RehearsalSchedulerOptions::processor_fraction
  std::size_t short_task_queue = 1024;   ///< short jobs that wait: registering, listing, looking up
  std::size_t client_short_tasks = 128;  ///< of one client that wait
  std::chrono::milliseconds store_patience{2000};  ///< see StoreStatusReader
  std::size_t max_queued_attempts = 4096;
  std::size_t client_attempts = 1024;  ///< of one client, taken in and not yet answered
  quotas::ClientRates client_rates;    ///< quotas of one client over time
  std::size_t max_robots = 1024;       ///< parsed and in memory; others are read when needed
  /// Of replies, leases, waiting fetches and fits, in all and of one client.
  catalog::CatalogState::Limits catalog;
  catalog::ExperienceIndex::Limits experience;
  BackupPlace backups;
  UpstreamOptions upstream;
  runtime::Clock clock;
  catalog::Catalog::Fit fit;  ///< empty: fit_distribution
  Jobs::Limits jobs;
  /// Events for people who watch; at most 1000 a second (event_feed.hpp). Called from any thread,
  /// must not block. Empty: no events.
  std::function<void(const Event&)> on_event;
  /// A followed distribution has a newer revision. Called on a worker.
  std::function<void(const Announcement&)> on_announcement = [](const Announcement&) {};
  /// The last client has stopped following a distribution. Called from any thread.
  std::function<void(const Digest& id)> on_unfollowed = [](const Digest&) {};
  /// next_deadline() is earlier than it was. Called from any thread.
  std::function<void()> wake = [] {};
  /// A line for people, without a line feed. Called from any thread, must not block for long.
  std::function<void(std::string_view)> log = [](std::string_view) {};
};

/// The use cases of kinshipd: register, report, fetch, administer. Knows neither DDS nor SQL. May
/// be shared between threads.
///
/// Every `done` is called at most once, on any thread, also during the call itself; it must not
/// throw or block. None is called after shutdown() has returned.
class Service {
 public:
  static constexpr RetryAfter kRetryAfter{1000};  ///< of requests for which there was no room

  Service(std::unique_ptr<store::Store> store, ServiceOptions options);
  ~Service();  ///< shutdown()
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /// Whether a client may send a request now, asked before the request is decoded; a refusal says
  /// when it may. Counts admitted requests.
  /// \param client  the caller, here and below; empty: no particular client, without a quota.
  /// \param bytes, attempts  of the request.
  std::optional<quotas::Refusal> admit(const std::string& client, std::size_t bytes,
                                       std::size_t attempts = 0);
  /// The same for a registration.
  std::optional<quotas::Refusal> admit_robot(const std::string& client, std::size_t bytes);

  /// Answers from memory without the store where possible. `done` is not called if the server is
  /// stopping or the store cannot take it: the client asks again.
  /// \param may_take  see RobotRegistry::register_robot.
  void register_robot(RobotDescription description, std::function<void(const RegisterReply&)> done,
                      const std::string& client = {},
                      runtime::RobotRegistry::LabelRule may_take = {});
  void report(ReportRequest request, std::function<void(const ReportReply&)> done,
              const std::string& client = {});
  /// \param waiter  the caller; see Catalog::fetch.
  void fetch(const FetchRequest& request, const std::string& waiter, catalog::FetchDone done);
  /// \param request_key  the request's key (catalog::client_of); see Administration::answer.
  /// \param caller  a request that it may not make (server/access) is refused first.
  void administer(AdminRequest request, const std::string& request_key,
                  const std::function<void(const AdminPage&)>& done, const Caller& caller);

  /// The labels of robots; those that are not registered are missing. An error says why a label
  /// cannot be read now: the store's error, or Unavailable if too many tasks wait. `done` is called
  /// at most once; not if the server is stopping.
  using RobotLabels = std::map<Digest, Result<std::string>>;
  void name_robots(const std::set<Digest>& robots, std::function<void(const RobotLabels&)> done,
                   const std::string& client);

  /// Answers and counts requests that are refused before they reach the service.
  void refuse_registration(const std::string& label, const std::string& why,
                           const std::function<void(const RegisterReply&)>& done);
  void refuse_fetch(const std::string& why, const std::function<void(const FetchReply&)>& done);
  /// The same for a fetch that cannot be answered now: Busy, and when to ask again.
  void postpone_fetch(const std::string& why, const std::function<void(const FetchReply&)>& done);

  /// Stops serving from memory data that another server changed in the store. The service calls it
  /// itself where a store has several servers. One call at a time. \throws Failure(Storage)
  void take_changes(const store::StoreChanges& changes);

  /// For the wait loop: when to call expire().
  std::optional<catalog::Catalog::TimePoint> next_deadline() const;
  void expire(catalog::Catalog::TimePoint now);

  ServerStatus status() const;
  /// All metrics, for monitoring of many servers (service_metrics.cpp). Reads the store's status;
  /// if that fails, its families are left out and one family says so. Not for the thread that waits
  /// on the network.
  void expose(metrics::Exposition& page) const;

  /// Accepts no more requests, makes reported attempts durable and answers them, answers waiting
  /// fetches Busy, gives up fits and jobs, and returns when all of that is done. A second call
  /// returns at once. Not to be called from a `done`.
  void shutdown();

 private:
  catalog::Catalog::Options catalog_options(const ServiceOptions& options);
  rehearsal::RehearsalSchedulerOptions rehearsal_options() const;
  Jobs::Options job_options(const ServiceOptions& options);
  Administration::Parts administration_parts();
  void take_in(ReportRequest request, std::function<void(const ReportReply&)> done,
               const std::string& client);
  void begin_epoch(const ConsistencyToken& lost);
  catalog::FetchDone of_this_epoch(catalog::FetchDone done) const;
  void answered(std::span<const catalog::AttemptCost> costs, std::span<const Receipt> receipts);
  struct Registration;
  using RegistrationPointer = std::shared_ptr<const Registration>;
  void begin(runtime::WorkerPool& pool, const RegistrationPointer& registration,
             std::function<void()> answer);
  void announce_registered(const Registration& registration, const RegisterReply& reply);
  runtime::WorkerPool& pool_for(AdminVerb verb);
  std::size_t short_tasks() const;
  std::optional<Error> refusal_of(const Caller& caller, const AdminRequest& request) const;
  void count_refused(const std::vector<Receipt>& receipts);
  void count_fetch(const FetchReply& reply);
  void count_admin(const AdminPage& page);
  Ingest::Options ingest_options();
  std::optional<quotas::Refusal> refused(std::optional<quotas::Refusal> refusal);
  std::optional<quotas::Refusal> may_begin_task(const std::string& client, const std::string& task);
  bool is_over_waiting(const std::string& client);
  std::vector<ClientUse> list_clients() const;
  std::vector<BoundUse> bounds(const store::StoreStatus& store) const;
  void log_fit(const Distribution& distribution) const;
  void expose_use(metrics::Exposition& page) const;
  void expose_guidance(metrics::Exposition& page) const;
  void new_experience(std::string_view task);
  void forget_task(const std::string& task);
  void start_forwarder();
  void stop_forwarder();
  void tell_line(std::string_view line);
  void commit_from_upstream(std::vector<store::ReplicatedReport> reports,
                            store::Store::ReportsDone done);
  void note_from_upstream(std::span<const catalog::AttemptCost> costs,
                          std::span<const Receipt> receipts);
  void expose_upstream(metrics::Exposition& page, std::uint64_t attempts) const;

  const ServiceOptions options_;
  const catalog::Catalog::TimePoint started_;
  const std::unique_ptr<store::Store> store_;
  mutable StoreStatusReader store_status_;
  runtime::ErrorCounters troubles_;
  Measures measures_;
  quotas::ClientQuotas clients_;
  quotas::KnownTasks known_tasks_;
  std::stop_source stop_source_;
  runtime::RobotRegistry robots_;
  catalog::ExperienceIndex experience_;
  std::atomic<std::uint64_t> refused_before_{0};  // attempts that never reached ingest_
  EventFeed events_;
  runtime::WorkerPool short_task_pool_;
  runtime::WorkerPool memory_task_pool_;  // asks the store nothing
  runtime::WorkerPool status_pool_;
  catalog::AdviceCache advice_;
  fitting::MemoryCeiling memory_;
  runtime::WorkerPool fitters_;
  catalog::Catalog catalog_;
  rehearsal::RehearsalScheduler rehearsals_;
  Ingest ingest_;
  Jobs jobs_;
  Administration administration_;
  runtime::WorkerPool reset_pool_;  // its thread uses the administration
  sites::UsedTasks used_tasks_;
  std::map<std::pair<std::string, Digest>, std::uint64_t> retired_generations_;  // of the watch
  StoreWatch watch_;                             // its thread uses all of the above
  std::unique_ptr<sites::Forwarder> forwarder_;  // last: its thread does, too; null: no site
};

}  // namespace kinship::service
