#include "server/service/service.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "proto/types/profile_text.hpp"
#include "server/catalog/experience_reply.hpp"
#include "server/rehearsal/rehearsal_reply.hpp"
#include "server/service/publish_events.hpp"
#include "server/service/reply_bytes.hpp"

namespace kinship::service {
namespace {

using runtime::Trouble;
using Priority = runtime::WorkerPool::Priority;

constexpr std::size_t kMaxResets = 16;  // that wait

quotas::Quota quota_of(catalog::ClientBound bound) {
  switch (bound) {
    case catalog::ClientBound::Leases:
      return quotas::Quota::Leases;
    case catalog::ClientBound::Fits:
      return quotas::Quota::Fits;
    default:
      return quotas::Quota::Waiting;
  }
}

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f s", value);
  return text;
}

}  // namespace

Service::Service(std::unique_ptr<store::Store> store, ServiceOptions options)
    : options_(std::move(options)),
      started_(options_.clock.now()),
      store_(std::move(store)),
      store_status_(*store_, options_.clock, options_.store_patience),
      troubles_(options_.clock, options_.log),
      clients_(options_.clock, options_.client_rates),
      robots_(*store_, {.max_robots = options_.max_robots,
                        .on_unreadable =
                            [this](const std::string& message) {
                              troubles_.add(Trouble::RobotUnreadable, message);
                            }}),
      experience_(*store_, robots_, options_.experience),
      events_(options_.clock, options_.on_event),
      short_task_pool_({.threads = 1,
                        .queue_limit = options_.short_task_queue,
                        .niceness = 0,
                        .client_limit = options_.client_short_tasks}),
      memory_task_pool_({.threads = 1,
                         .queue_limit = options_.short_task_queue,
                         .niceness = 0,
                         .client_limit = options_.client_short_tasks}),
      status_pool_({.threads = 1,
                    .queue_limit = options_.short_task_queue,
                    .niceness = 0,
                    .client_limit = options_.client_short_tasks}),
      advice_([this](const Digest& robot,
                     const std::string& task) { return store_->attempt_totals(robot, task); },
              [this](const Digest& id) -> std::optional<catalog::Context> {
                const auto distribution = store_->find_distribution(id);
                if (!distribution)
                  return std::nullopt;
                return catalog::Context{distribution->engines, distribution->profile};
              },
              [this](std::function<void()> run) {
                return short_task_pool_.submit(runtime::WorkerPool::Priority::Background,
                                               {.run = std::move(run), .abandon = {}});
              }),
      memory_(options_.fit_memory_bytes),
      fitters_({.threads = options_.fit_threads,
                .queue_limit = options_.fit_queue,
                .niceness = options_.fit_niceness}),
      catalog_({*store_, *store_, robots_, short_task_pool_, fitters_, options_.clock, &memory_},
               catalog_options(options_)),
      rehearsals_({*store_, robots_, options_.clock, experience_, &memory_}, rehearsal_options()),
      ingest_(*store_, robots_, short_task_pool_, ingest_options()),
      jobs_(options_.clock, job_options(options_)),
      administration_(administration_parts()),
      reset_pool_({.threads = 1, .queue_limit = kMaxResets, .niceness = options_.fit_niceness}),
      watch_(*store_, [this](const store::StoreChanges& changes) { take_changes(changes); }) {
  start_forwarder();
}

Service::~Service() { shutdown(); }

catalog::Catalog::Options Service::catalog_options(const ServiceOptions& options) {
  catalog::Catalog::Options catalog;
  catalog.limits = options.catalog;
  catalog.fit = options.fit;
  catalog.on_fit = [this](const Distribution& distribution) {
    measures_.count(distribution);
    log_fit(distribution);
    publish_fit(events_, robots_, distribution);
  };
  catalog.on_trouble = [this](const Digest& id, FetchStatus status, const std::string& message) {
    troubles_.add(status == FetchStatus::Busy ? Trouble::FitEnded : Trouble::FitMemory,
                  "distribution " + id.short_hex() + ": " + message);
  };
  catalog.on_over_quota = [this](const std::string& client, catalog::ClientBound bound,
                                 const std::string& message) {
    clients_.count_refusal(client, quota_of(bound));
    troubles_.add(Trouble::FetchQuota, message);
  };
  catalog.announce = [this](Announcement announcement) {
    announcement.store_epoch = store_->epoch();
    options_.on_announcement(announcement);
  };
  catalog.on_unfollowed = options.on_unfollowed;
  catalog.wake = options.wake;
  catalog.advice.advise = [this](const std::string& task, const Digest& robot,
                                 const Profile& profile) {
    return advice_.advise(task, robot, {fitting::engines(), profile.name},
                          profile.recommended_share);
  };
  catalog.advice.version = [this](const std::string& task, const Digest& robot) {
    return advice_.version(task, robot);
  };
  return catalog;
}

rehearsal::RehearsalSchedulerOptions Service::rehearsal_options() const {
  rehearsal::RehearsalSchedulerOptions options;
  options.processor_fraction = options_.rehearsal_fraction;
  options.wake = options_.wake;
  options.log = options_.log;
  return options;
}

Jobs::Options Service::job_options(const ServiceOptions& options) {
  return {
      .limits = options.jobs, .niceness = options.fit_niceness, .on_end = [this](const Job& job) {
        measures_.count(job);
        publish_job(events_, job);
      }};
}

Administration::Parts Service::administration_parts() {
  return {.store = *store_,
          .robots = robots_,
          .jobs = jobs_,
          .clock = options_.clock,
          .status = [this] { return status(); },
          .advise =
              [this](const Distribution& distribution) {
                const Result<Profile> profile = profile_from_text(distribution.profile);
                return advice_.advise(distribution.task, distribution.robot,
                                      {distribution.engines, distribution.profile},
                                      profile ? fitting::first_share(*profile, distribution.state)
                                              : distribution.advice.recommended_share);
              },
          .rehearsal = [this](const Digest& id) { return rehearsals_.find(id); },
          .forget_distribution = [this](const Digest& id) { catalog_.evict(id); },
          .forget_task = [this](const std::string& task) { forget_task(task); },
          .forget_robot =
              [this](const Digest& robot) {
                catalog_.forget_robot(robot);
                advice_.forget(robot);
              },
          .fit_trouble = [this](const Digest& id) { return catalog_.trouble_of(id); },
          .memory = &memory_,
          .clients = [this] { return list_clients(); },
          .backups = options_.backups,
          .stop = stop_source_.get_token(),
          .on_change =
              [this](const std::string& task, const std::string& what) {
                options_.log((task.empty() ? "" : "task '" + task + "': ") + what);
                events_.tell(EventKind::Administration, task, {}, [&] { return what; });
                if (forwarder_)
                  forwarder_->wake();
              }};
}

void Service::answered(std::span<const catalog::AttemptCost> costs,
                       std::span<const Receipt> receipts) {
  for (std::size_t i = 0; i < std::min(costs.size(), receipts.size()); ++i)
    if (receipts[i].status == ReceiptStatus::Stored ||
        receipts[i].status == ReceiptStatus::Recorded)
      advice_.add(costs[i]);
  publish_report(events_, robots_, costs, receipts);
  if (forwarder_)
    forwarder_->wake();
}

void Service::report(ReportRequest request, std::function<void(const ReportReply&)> done,
                     const std::string& client) {
  if (!store_->may_have_lost(request.known_mark))
    return take_in(std::move(request), std::move(done), client);
  // No answer if it fails: a newer mark in it would make the client forget the lost one.
  auto run = [this, request = std::move(request), done, client]() mutable {
    try {
      if (store_->has_lost(request.known_mark))
        begin_epoch(request.known_mark);
    } catch (const std::exception& exception) {
      return options_.log(std::string("store: rolled back, no new epoch yet: ") + exception.what());
    }
    take_in(std::move(request), std::move(done), client);
  };
  if (!short_task_pool_.submit(Priority::Interactive,
                               {.run = std::move(run), .abandon = {}, .client = client})) {
    if (stop_source_.stop_requested())
      return;
    ReportReply busy;  // without the store's epoch and mark: the client keeps those it has
    busy.message = "the server is busy";
    busy.retry_after = kRetryAfter;
    done(busy);
  }
}

void Service::begin_epoch(const HistoryMark& lost) {
  if (!store_->begin_epoch_if_lost(lost))
    return;  // another client was first
  const std::string what = "the store was rolled back behind receipts of clients: epoch " +
                           store_->epoch().text() + " begins, they offer again what is missing";
  options_.log(what);
  events_.tell(EventKind::Administration, "", {}, [&] { return what; });
}

void Service::take_in(ReportRequest request, std::function<void(const ReportReply&)> done,
                      const std::string& client) {
  refused_before_ += request.refused.size();
  publish_refused(events_, request.refused);
  ingest_.submit(
      std::move(request.attempts),
      [this, refused = std::move(request.refused), done = std::move(done),
       began = options_.clock.now()](const std::vector<Receipt>& receipts, RetryAfter retry_after) {
        store::StorePoint point = store_->point();
        ReportReply reply{point.epoch, receipts, std::move(point.mark), retry_after};
        reply.receipts.insert(reply.receipts.end(), refused.begin(), refused.end());
        count_refused(reply.receipts);
        measures_.count(reply.receipts, options_.clock.now() - began);
        done(reply);
      },
      client);
}

/// A distribution in memory is the one in the store, also if an epoch began meanwhile.
catalog::FetchDone Service::of_this_epoch(catalog::FetchDone done) const {
  return [this, done = std::move(done)](const FetchReply& reply) {
    const Uuid epoch = store_->epoch();
    if (!reply.distribution || reply.distribution->store_epoch == epoch)
      return done(reply);
    FetchReply renewed = reply;
    renewed.distribution->store_epoch = epoch;
    done(renewed);
  };
}

void Service::fetch(const FetchRequest& request, const std::string& waiter,
                    catalog::FetchDone done) {
  if (forwarder_ && used_tasks_.note(request.task, options_.clock.unix_ms()))
    forwarder_->wake_for_task();
  // Shared by request and answer: they may be on two threads, in either order.
  const auto watch = std::make_shared<FetchWatch>(options_.clock);
  done = [this, watch, client = std::string(catalog::client_of(waiter)),
          done = std::move(done)](const FetchReply& reply) {
    count_fetch(reply);
    clients_.count_reply(client, reply_bytes(reply));
    measures_.count(reply, *watch);
    done(reply);
  };
  done = of_this_epoch(std::move(done));
  if (request.experience_bytes > 0)
    done =
        rehearsal::with_rehearsal(rehearsals_, request, options_.clock.now(),
                                  catalog::with_experience(experience_, request, std::move(done)));
  catalog::FetchDone answer = [watch, done = std::move(done)](const FetchReply& reply) {
    watch->set_answered();
    done(reply);
  };
  if (options_.on_event)  // the request is copied for watchers alone
    answer = [this, request, answer = std::move(answer)](const FetchReply& reply) {
      answer(reply);
      publish_fetch(events_, robots_, request, reply);
    };
  catalog_.fetch(request, waiter, std::move(answer));
  watch->set_asked();
}

std::optional<catalog::Catalog::TimePoint> Service::next_deadline() const {
  const std::optional<catalog::Catalog::TimePoint> fetch = catalog_.next_deadline();
  std::optional<catalog::Catalog::TimePoint> next = fetch;
  for (const auto& other : {jobs_.next_deadline(), rehearsals_.next_deadline()})
    if (other && (!next || *other < *next))
      next = other;
  return next;
}

void Service::expire(catalog::Catalog::TimePoint now) {
  catalog_.expire(now);
  rehearsals_.expire(now);
  jobs_.expire(now);
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
  status.reports_received = ingest_.received() + refused_before_;
  status.reports_refused = ingest_.refused() + refused_before_;
  status.fetches = catalog_.fetches();
  status.fetches_from_memory = catalog_.fetches_from_memory();
  status.fits = catalog_.fits();
  status.followed = catalog_.followed();
  status.jobs = jobs_.active();
  status.queued_reports = ingest_.queued();
  status.queued_fits = fitters_.queued();
  status.store_bytes = store.bytes;
  status.writable = store.writable;
  status.storage_message = store.message;
  status.rollbacks = store.rollbacks;
  status.replicas = store.replicas;
  status.scrubbed_ms = store.scrubbed_ms;
  status.scrub_part = store.scrub_part;
  const rehearsal::RehearsalTotals rehearsals = rehearsals_.totals();
  status.rehearsals = rehearsals.done;
  status.queued_rehearsals = rehearsals.queued;
  status.rehearsal_time_s = rehearsals.processor_time_s;
  status.troubles = troubles_.counts();
  status.dropped_paths = store.dropped_paths;
  status.bounds = bounds(store);
  status.credentials_expire_ms = options_.credentials_expire_ms;
  if (forwarder_)
    status.upstream = forwarder_->status(store.attempts);
  return status;
}

std::vector<BoundUse> Service::bounds(const store::StoreStatus& store) const {
  const catalog::CatalogUse use = catalog_.use();
  std::vector<BoundUse> bounds = {
      {"reports on their way", ingest_.queued(), options_.max_queued_attempts},
      {"fits that wait", fitters_.queued(), options_.fit_queue},
      {"MB of memory of fits", memory_.reserved() >> 20U, options_.fit_memory_bytes >> 20U},
      {"fetches that wait", use.waiters, options_.catalog.max_waiters},
      {"leases", use.holds, options_.catalog.max_leases},
      {"clients told apart", clients_.size(), options_.client_rates.max_clients},
      {"short tasks that wait", short_tasks(), options_.short_task_queue},
      {"jobs", jobs_.active(), options_.jobs.queued + 1},
      {"robots in memory", robots_.in_memory(), options_.max_robots},
      {"MB of distributions in memory", use.memory_bytes >> 20U,
       options_.catalog.memory.bytes >> 20U},
      {"MB of ways of paths in memory", experience_.bytes_of_paths() >> 20U,
       options_.experience.paths.bytes >> 20U},
      {"MB that fits keep for the next ones", use.fit_memory_bytes >> 20U,
       fitting::FitMemory::kDefaultBytes >> 20U}};
  if (store.max_distribution_bytes > 0)
    bounds.push_back({"MB of distributions in the store", store.distribution_bytes >> 20U,
                      store.max_distribution_bytes >> 20U});
  if (store.max_paths_per_pair > 0)
    bounds.push_back({"paths, of the robot and task with most", store.most_paths_of_pair,
                      store.max_paths_per_pair});
  return bounds;
}

void Service::count_refused(const std::vector<Receipt>& receipts) {
  const auto count = [&](ReceiptStatus status, Trouble what, const std::string& words) {
    const auto is_one = [status](const Receipt& receipt) { return receipt.status == status; };
    const auto first = std::find_if(receipts.begin(), receipts.end(), is_one);
    if (first == receipts.end())
      return;
    const auto number = std::count_if(first, receipts.end(), is_one);
    troubles_.add(what,
                  std::to_string(number) + " of " + std::to_string(receipts.size()) + " attempts " +
                      words + ", first: " + first->message,
                  static_cast<std::uint64_t>(number));
  };
  count(ReceiptStatus::Refused, Trouble::ReportRefused, "refused");
  count(ReceiptStatus::TryAgain, Trouble::ReportTryAgain, "to be sent again");
  count(ReceiptStatus::UnknownRobot, Trouble::ReportUnknown, "of robots that are not registered");
}

void Service::count_fetch(const FetchReply& reply) {
  if (reply.status == FetchStatus::Busy)
    troubles_.add(Trouble::FetchBusy, reply.message);
  else if (reply.status == FetchStatus::Refused)
    troubles_.add(Trouble::FetchRefused, reply.message);
}

void Service::count_admin(const AdminPage& page) {
  if (page.status == AdminStatus::Failed)
    troubles_.add(Trouble::AdminFailed, page.message);
  else if (page.status == AdminStatus::Refused)
    troubles_.add(Trouble::AdminRefused, page.message);
}

void Service::log_fit(const Distribution& distribution) const {
  std::uint64_t paths = 0;
  for (const Source& source : distribution.sources)
    paths += source.paths;
  const bool failed = distribution.state == DistributionState::Failed;
  options_.log(
      "fit " + distribution.id.short_hex() + " revision " + std::to_string(distribution.revision) +
      " for robot " + distribution.robot.short_hex() + ", task '" + distribution.task +
      "': " + std::to_string(distribution.configurations) + " configurations from " +
      std::to_string(paths) + " paths, transfer " + seconds(distribution.transfer_time_s) +
      ", fit " + seconds(distribution.fit_time_s) +
      (distribution.fit ? ", " + describe(*distribution.fit) : "") + (failed ? ", failed" : "") +
      (distribution.reason.empty() ? "" : ": " + distribution.reason));
}

void Service::shutdown() {
  using runtime::WorkerPool;
  watch_.stop();
  stop_source_.request_stop();  // resets
  stop_forwarder();
  robots_.stop();
  catalog_.stop();
  experience_.stop();  // a rehearsal waits for it
  rehearsals_.stop();
  jobs_.stop();
  reset_pool_.stop(WorkerPool::Leftovers::Abandon);
  // Each task that waits in these can be requested again.
  memory_task_pool_.stop(WorkerPool::Leftovers::Abandon);
  short_task_pool_.stop(WorkerPool::Leftovers::Abandon);
  status_pool_.stop(WorkerPool::Leftovers::Abandon);
  fitters_.stop(WorkerPool::Leftovers::Abandon);
  ingest_.drain();
  store_status_.stop();
}

}  // namespace kinship::service
