#include "server/service/service.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/runtime/memory_reserve.hpp"

namespace kinship::service {

Service::Service(std::unique_ptr<store::Store> store, ServiceOptions options)
    : options_(std::move(options)),
      started_(options_.clock.now()),
      store_(std::move(store)),
      store_status_(*store_, options_.clock, options_.store_patience),
      troubles_(options_.clock, options_.log),
      events_(options_.clock, options_.on_event),
      clients_(options_.clock, options_.client_rates),
      robots_(*store_, {.max_robots = options_.max_robots,
                        .max_mesh_bytes = options_.max_mesh_bytes,
                        .on_unreadable =
                            [this](const std::string& message) {
                              troubles_.add(runtime::Trouble::RobotUnreadable, message);
                            }}),
      pools_(options_.short_task_queue, options_.client_short_tasks, clients_),
      upstream_(parts(), *store_),
      fetches_(parts(), *store_, *store_, *store_, upstream_),
      reports_(parts(), *store_, fetches_, upstream_),
      registration_(parts()),
      administration_(parts(),
                      {*store_, fetches_, reports_, upstream_, [this] { return status(); }}),
      watch_(*store_,
             [this](const store::StoreChanges& changes) { fetches_.take_changes(changes); }) {
  upstream_.start(reports_, fetches_);
}

Service::~Service() { shutdown(); }

ServiceParts Service::parts() {
  return {options_, troubles_, measures_, events_, clients_, robots_, pools_};
}

std::optional<quotas::Refusal> Service::admit(const std::string& client, std::size_t bytes,
                                              std::size_t attempts) {
  return counted(clients_.admit(client, bytes, attempts));
}

std::optional<quotas::Refusal> Service::admit_robot(const std::string& client, std::size_t bytes) {
  if (auto refusal = clients_.may_add(client, quotas::Quota::Robots))
    return counted(std::move(refusal));
  return admit(client, bytes);
}

std::optional<quotas::Refusal> Service::counted(std::optional<quotas::Refusal> refusal) {
  if (refusal)
    troubles_.add(runtime::Trouble::ClientQuota, refusal->message);
  return refusal;
}

std::optional<Service::TimePoint> Service::next_deadline() const {
  std::optional<TimePoint> next = fetches_.catalog().next_deadline();
  for (const auto& other :
       {fetches_.rehearsals().next_deadline(), administration_.jobs().next_deadline()})
    if (other && (!next || *other < *next))
      next = other;
  return next;
}

void Service::expire(TimePoint now) {
  fetches_.expire(now);
  administration_.expire(now);
  note_memory();
}

/// What was refused since the last look, whoever asked for it.
void Service::note_memory() {
  if (const std::uint64_t refusals = runtime::take_memory_refusals(); refusals > 0)
    troubles_.add(runtime::Trouble::NoMemory,
                  "the system has no more memory for kinshipd; what asked for it was put off",
                  refusals);
  runtime::renew_memory_reserve();
}

ServerStatus Service::status() const {
  const store::StoreStatus store = store_status_.read();
  ServerStatus status;
  status.version = options_.version;
  status.store_file = store.file;
  status.store_epoch = store.epoch;
  status.schema_version = store.schema_version;
  status.uptime_s = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::seconds>(options_.clock.now() - started_).count());
  status.robots = store.robots;
  status.tasks = store.tasks;
  status.paths = store.paths;
  status.attempts = store.attempts;
  status.distributions = store.distributions;
  status.reports_received = reports_.ingest().received() + reports_.refused_before();
  status.reports_refused = reports_.ingest().refused() + reports_.refused_before();
  status.fetches = fetches_.catalog().fetches();
  status.fetches_from_memory = fetches_.catalog().fetches_from_memory();
  status.fits = fetches_.catalog().fits();
  status.followed = fetches_.catalog().followed();
  status.jobs = administration_.jobs().active();
  status.queued_reports = reports_.ingest().queued();
  status.queued_fits = fetches_.queued_fits();
  status.store_bytes = store.bytes;
  status.writable = store.writable;
  status.storage_message = store.message;
  status.rollbacks = store.rollbacks;
  status.replicas = store.replicas;
  status.scrubbed_ms = store.scrubbed_ms;
  status.scrub_part = store.scrub_part;
  const rehearsal::RehearsalTotals rehearsals = fetches_.rehearsals().totals();
  status.rehearsals = rehearsals.done;
  status.queued_rehearsals = rehearsals.queued;
  status.rehearsal_time_s = rehearsals.processor_time_s;
  status.troubles = troubles_.counts();
  std::ranges::move(options_.network_troubles(), std::back_inserter(status.troubles));
  status.dropped_paths = store.dropped_paths;
  status.meshes = store.meshes;
  status.mesh_bytes = store.mesh_bytes;
  status.guided_means = store.guided_means;
  status.control_means = store.control_means;
  status.bounds = bounds(store);
  status.credentials_expire_ms = options_.credentials_expire_ms;
  status.upstream = upstream_.status(store.attempts);
  status.challenge = options_.challenge();
  return status;
}

std::vector<BoundUse> Service::bounds(const store::StoreStatus& store) const {
  const catalog::CatalogUse use = fetches_.catalog().use();
  std::vector<BoundUse> bounds = {
      {"reports on their way", reports_.ingest().queued(), options_.max_queued_attempts},
      {"fits that wait", fetches_.queued_fits(), options_.fit_queue},
      {"MB of memory of fits", fetches_.memory().reserved() >> 20U,
       options_.fit_memory_bytes >> 20U},
      {"fetches that wait", use.waiters, options_.catalog.max_waiters},
      {"leases", use.holds, options_.catalog.max_leases},
      {"clients told apart", clients_.size(), options_.client_rates.max_clients},
      {"short tasks that wait", pools_.queued(), options_.short_task_queue},
      {"jobs", administration_.jobs().active(), options_.jobs.queued + 1},
      {"robots in memory", robots_.in_memory(), options_.max_robots},
      {"MB of distributions in memory", use.memory_bytes >> 20U,
       options_.catalog.memory.bytes >> 20U},
      {"MB of ways of paths in memory", fetches_.experience().bytes_of_paths() >> 20U,
       options_.experience.paths.bytes >> 20U},
      {"MB that fits keep for the next ones", use.fit_memory_bytes >> 20U,
       fitting::FitMemory::kDefaultBytes >> 20U}};
  std::ranges::move(options_.network_bounds(), std::back_inserter(bounds));
  if (store.max_distribution_bytes > 0)
    bounds.push_back({"MB of distributions in the store", store.distribution_bytes >> 20U,
                      store.max_distribution_bytes >> 20U});
  if (store.meshes > 0)
    bounds.push_back(
        {"MB of meshes in the store", store.mesh_bytes >> 20U, options_.max_mesh_bytes >> 20U});
  if (store.max_search_bytes > 0)
    bounds.push_back({"MB of search records in the store", store.search_bytes >> 20U,
                      store.max_search_bytes >> 20U});
  if (store.max_paths_per_pair > 0)
    bounds.push_back({"paths, of the robot and task with most", store.most_paths_of_pair,
                      store.max_paths_per_pair});
  return bounds;
}

void Service::shutdown() {
  watch_.stop();
  pools_.request_stop();  // resets
  upstream_.stop();
  robots_.stop();
  fetches_.stop();
  administration_.stop();
  pools_.stop();  // each task that waits in these can be requested again
  fetches_.join();
  reports_.drain();
  store_status_.stop();
}

}  // namespace kinship::service
