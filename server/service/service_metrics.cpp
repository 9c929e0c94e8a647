// The metrics of a service, as families that Prometheus reads; docs/operations.md describes them.

#include <algorithm>
#include <optional>
#include <string>

#include "proto/evidence/cost_ratio.hpp"
#include "server/service/publish_events.hpp"
#include "server/service/service.hpp"

namespace kinship::service {
namespace {

using metrics::Exposition;
using metrics::Type;

/// (task, robot) with series of their own; each has 7.
constexpr std::size_t kMaxGuidancePairs = 100;

std::string label_of(std::string_view words) {
  std::string label(words);
  std::ranges::replace(label, ' ', '_');
  return label;
}

double seconds_of(std::int64_t unix_ms) { return static_cast<double>(unix_ms) / 1000; }

void expose_measures(Exposition& page, const Measures& measures) {
  page.family("kinship_report_attempts_total", Type::Counter, "Attempts of reports, by receipt.");
  for (std::size_t i = 0; i < kReceiptNames.size(); ++i)
    page.sample(measures.attempts[i].value(), {{"receipt", kReceiptNames[i]}});
  page.family("kinship_receipt_latency_seconds", Type::Histogram,
              "From a batch of reports to its receipts, which follow a durable commit.");
  page.histogram(measures.receipts);
  page.family(
      "kinship_fetch_latency_seconds", Type::Histogram,
      "From a fetch to its reply, by outcome: a distribution from memory, from the store or "
      "fitted meanwhile; or why there is none.");
  for (std::size_t i = 0; i < kFetchOutcomeNames.size(); ++i)
    page.histogram(measures.fetches[i], {{"outcome", kFetchOutcomeNames[i]}});
  page.family("kinship_transfer_duration_seconds", Type::Histogram,
              "Moving the experience of a task onto a robot, once per fit.");
  page.histogram(measures.transfers);
  page.family("kinship_fit_duration_seconds", Type::Histogram,
              "Fitting a mixture to configurations.");
  page.histogram(measures.fits);
  page.counter("kinship_failed_fits_total", "Fits whose distribution failed for a known reason.",
               measures.failed_fits.value());
  constexpr std::array<std::string_view, 3> kStates = {"done", "failed", "cancelled"};
  page.family("kinship_jobs_ended_total", Type::Counter, "Long admin verbs, by how they ended.");
  for (std::size_t i = 0; i < kStates.size(); ++i)
    page.sample(measures.jobs[i].value(), {{"state", kStates[i]}});
}

/// Each reason from the start, so that a rate sees the first one.
void expose_refusals(Exposition& page, const std::vector<TroubleCount>& counts) {
  page.family("kinship_refusals_total", Type::Counter,
              "What was refused, put off or failed for a client, by reason.");
  for (const std::string_view name : runtime::kTroubleNames) {
    const auto found = std::ranges::find(counts, name, &TroubleCount::what);
    page.sample(found == counts.end() ? std::uint64_t{0} : found->count,
                {{"reason", label_of(name)}});
  }
}

/// One family of a few series, however many clients there are.
void expose_quotas(Exposition& page, const quotas::ClientQuotas& clients) {
  page.family("kinship_quota_refusals_total", Type::Counter,
              "Requests of clients that had taken or held as much as one may, by quota.");
  for (std::size_t i = 0; i < quotas::kQuotaNames.size(); ++i)
    page.sample(clients.refusals(static_cast<quotas::Quota>(i)),
                {{"quota", quotas::kQuotaNames[i]}});
  page.gauge("kinship_clients_told_apart", "Clients whose use is known, see kinship status.",
             std::uint64_t{clients.size()});
}

void expose_rows(Exposition& page, const store::StoreStatus& store) {
  page.gauge("kinship_store_robots", "Robots that are registered.", store.robots);
  page.gauge("kinship_store_tasks", "Tasks with experience.", store.tasks);
  page.gauge("kinship_store_paths", "Paths that are kept.", store.paths);
  page.gauge("kinship_store_attempts", "Attempts that are recorded.", store.attempts);
  page.gauge("kinship_store_distributions", "Distributions that are kept.", store.distributions);
  page.gauge("kinship_store_dropped_paths", "Paths that were beyond the cap of their pair.",
             store.dropped_paths);
  page.gauge("kinship_store_largest_pair_paths", "Paths of the robot and task with most.",
             store.most_paths_of_pair);
  page.gauge("kinship_store_pair_paths_limit", "Paths that a robot and task keep; 0: all.",
             store.max_paths_per_pair);
}

/// Of a database that has other hosts; without series if there is none.
void expose_replicas(Exposition& page, const std::vector<ReplicaUse>& replicas) {
  page.family("kinship_replica_readings_total", Type::Counter,
              "Readings of fits by host; what a standby did not answer the primary did.");
  for (const ReplicaUse& replica : replicas) {
    page.sample(replica.readings, {{"host", replica.host}, {"result", "answered"}});
    page.sample(replica.behind, {{"host", replica.host}, {"result", "behind"}});
    page.sample(replica.failed, {{"host", replica.host}, {"result", "failed"}});
  }
}

void expose_store(Exposition& page, const store::StoreStatus& store) {
  page.gauge("kinship_store_writable", "1 if reports are taken, else 0.",
             std::uint64_t{store.writable});
  page.gauge("kinship_store_damaged",
             "1 if something in the store cannot be read any more, else 0.",
             std::uint64_t{store.damaged});
  page.gauge("kinship_store_bytes", "Size of the store's file.", store.bytes);
  page.gauge("kinship_store_wal_bytes", "Of changes that are not yet in the file.",
             store.wal_bytes);
  page.gauge("kinship_store_distribution_bytes", "Of distributions in the store, about.",
             store.distribution_bytes);
  page.gauge("kinship_store_distribution_limit_bytes", "Those that are kept; 0: all.",
             store.max_distribution_bytes);
  page.gauge("kinship_store_meshes", "Contents of robots' meshes.", store.meshes);
  page.gauge("kinship_store_mesh_bytes", "Of these, compressed.", store.mesh_bytes);
  page.gauge("kinship_store_search_bytes", "Of search records in the store, about.",
             store.search_bytes);
  page.gauge("kinship_store_search_limit_bytes", "Those that are kept; 0: none.",
             store.max_search_bytes);
  expose_rows(page, store);
  expose_replicas(page, store.replicas);
  page.gauge("kinship_store_scrub_progress_ratio",
             "How much of the store was read in search of damage since that began anew.",
             store.scrub_part);
  page.gauge("kinship_store_scrubbed_timestamp_seconds",
             "When the store was last read through in search of damage; 0: never.",
             seconds_of(store.scrubbed_ms));
  page.counter("kinship_store_epoch_changes_total",
               "New epochs because the store was found to be a copy or rolled back.",
               store.rollbacks);
  page.family("kinship_store_info", Type::Gauge, "The store's epoch and schema; always 1.");
  page.sample(std::uint64_t{1},
              {{"epoch", store.epoch.text()}, {"schema", std::to_string(store.schema_version)}});
}

/// Guidance of a robot in a task.
struct Pair {
  std::string task, robot;
  Advice advice;
  evidence::CostRatio ratio;
};

void expose_modes(Exposition& page, const std::vector<Pair>& pairs,
                  std::uint64_t ModeEvidence::*number) {
  const auto expose = [&](const Pair& pair, std::string_view mode,
                          const std::optional<ModeEvidence>& evidence) {
    page.sample(evidence ? (*evidence).*number : std::uint64_t{0},
                {{"task", pair.task}, {"robot", pair.robot}, {"mode", mode}});
  };
  for (const Pair& pair : pairs) {
    expose(pair, "guided", pair.advice.guided);
    expose(pair, "control", pair.advice.control);
  }
}

}  // namespace

void Service::expose(Exposition& page) const {
  expose_measures(page, measures_);
  expose_refusals(page, troubles_.counts());
  expose_quotas(page, clients_);
  page.gauge("kinship_credentials_expiry_timestamp_seconds",
             "When the server's certificate ends; 0: it runs without security.",
             seconds_of(options_.credentials_expire_ms));
  expose_use(page);
  expose_guidance(page);
  std::optional<store::StoreStatus> store;
  try {
    store = store_status_.read();
  } catch (const std::exception&) {  // a scrape is most wanted when the store is ill
  }
  page.gauge("kinship_store_readable", "1 if the store tells its status, else 0.",
             std::uint64_t{store.has_value()});
  if (store)
    expose_store(page, *store);
  upstream_.expose(page, store ? store->attempts : 0);
}

/// Bounded resources, and their use.
void Service::expose_use(Exposition& page) const {
  const catalog::CatalogUse use = fetches_.catalog().use();
  const rehearsal::RehearsalTotals rehearsals = fetches_.rehearsals().totals();
  struct Bound {
    std::string_view name;
    std::uint64_t used, limit;
  };
  const auto expose = [&page](std::string_view name, std::string_view limit_name,
                              std::string_view label, std::string_view help,
                              std::initializer_list<Bound> bounds) {
    page.family(name, Type::Gauge, help);
    for (const Bound& bound : bounds)
      page.sample(bound.used, {{label, bound.name}});
    page.family(limit_name, Type::Gauge, "Its bound: more is answered busy, or makes room.");
    for (const Bound& bound : bounds)
      page.sample(bound.limit, {{label, bound.name}});
  };
  expose(
      "kinship_queue_length", "kinship_queue_limit", "queue", "What waits or is under way.",
      {{"reports", reports_.ingest().queued(), options_.max_queued_attempts},
       {"fits", fetches_.queued_fits(), options_.fit_queue},
       {"fetches", use.waiters, options_.catalog.max_waiters},
       {"short_tasks", pools_.queued(), options_.short_task_queue},
       {"jobs", administration_.jobs().active(), options_.jobs.queued + 1},
       {"rehearsals", rehearsals.queued, rehearsal::RehearsalSchedulerOptions{}.max_rehearsals}});
  expose(
      "kinship_memory_bytes", "kinship_memory_limit_bytes", "use", "Memory, about.",
      {{"running_fits", fetches_.memory().reserved(), options_.fit_memory_bytes},
       {"kept_by_fits", use.fit_memory_bytes, fitting::FitMemory::kDefaultBytes},
       {"distributions", use.memory_bytes, options_.catalog.memory.bytes},
       {"ways_of_paths", fetches_.experience().bytes_of_paths(), options_.experience.paths.bytes}});
  page.counter("kinship_cache_hits_total", "Fetches that memory answered.",
               fetches_.catalog().fetches_from_memory());
  page.counter("kinship_cache_misses_total", "Fetches that it did not answer.",
               fetches_.catalog().fetches_not_from_memory());
  page.counter("kinship_cache_evictions_total",
               "Distributions dropped from memory for want of room.", use.dropped);
  page.gauge("kinship_cache_entries", "Distributions in memory.", std::uint64_t{use.in_memory});
  page.gauge("kinship_robots_in_memory", "Robots that are parsed.",
             std::uint64_t{robots_.in_memory()});
  page.gauge("kinship_leases", "Clients' holds on followed distributions.",
             std::uint64_t{use.holds});
  page.gauge("kinship_followed_distributions", "Distributions that somebody follows.",
             std::uint64_t{fetches_.catalog().followed()});
  page.counter("kinship_rehearsals_total", "Rehearsals that are done.", rehearsals.done);
  page.counter("kinship_rehearsal_cpu_seconds_total", "Processor time that they took.",
               rehearsals.processor_time_s);
  page.counter("kinship_events_dropped_total", "Events that were counted, not told to watchers.",
               events_.dropped());
}

/// Of the pairs with most attempts among the ones fetched for since the start.
void Service::expose_guidance(Exposition& page) const {
  const catalog::GuidanceWorths worths = fetches_.advice().worths(kMaxGuidancePairs);
  std::vector<Pair> pairs;
  for (const catalog::GuidanceWorth& worth : worths.pairs)
    pairs.push_back({.task = worth.task,
                     .robot = name_of(robots_, worth.robot),
                     .advice = worth.advice,
                     .ratio = evidence::compare_costs(worth.advice.recent)});
  page.family("kinship_guidance_attempts_total", Type::Counter,
              "Attempts with guidance, and of the control without it.");
  expose_modes(page, pairs, &ModeEvidence::attempts);
  page.family("kinship_guidance_solved_total", Type::Counter, "Those that solved their problem.");
  expose_modes(page, pairs, &ModeEvidence::solved);
  page.family(
      "kinship_guidance_cost_ratio", Type::Gauge,
      "Processor time (collision checks, if that is unknown) of a query without guidance / with "
      "it, the median of what the newest attempts say; above 1 guidance saves. Missing until both "
      "modes have attempts.");
  for (const Pair& pair : pairs)
    if (pair.ratio.is_compared)
      page.sample(pair.ratio.quantile(0), {{"task", pair.task}, {"robot", pair.robot}});
  page.family("kinship_guidance_cheaper_probability", Type::Gauge,
              "Probability that guidance is cheaper, 0 to 1; missing as the ratio.");
  for (const Pair& pair : pairs)
    if (pair.ratio.is_compared)
      page.sample(pair.ratio.guided_is_cheaper, {{"task", pair.task}, {"robot", pair.robot}});
  page.family("kinship_guidance_share_ratio", Type::Gauge,
              "Share of guided samples that is recommended, 0 to 1.");
  for (const Pair& pair : pairs)
    page.sample(pair.advice.recommended_share, {{"task", pair.task}, {"robot", pair.robot}});
  page.gauge("kinship_guidance_left_out_pairs",
             "Pairs of a robot and task beyond the 100 with most attempts, without series.",
             std::uint64_t{worths.left_out});
}

}  // namespace kinship::service
