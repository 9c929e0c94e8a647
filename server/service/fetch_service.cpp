#include "server/service/fetch_service.hpp"

#include <cstdio>
#include <set>
#include <utility>

#include "proto/types/profile_text.hpp"
#include "server/catalog/experience_reply.hpp"
#include "server/rehearsal/rehearsal_reply.hpp"
#include "server/service/publish_events.hpp"
#include "server/service/reply_bytes.hpp"

namespace kinship::service {
namespace {

using runtime::Trouble;

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

rehearsal::RehearsalSchedulerOptions rehearsal_options(const ServiceOptions& options) {
  rehearsal::RehearsalSchedulerOptions rehearsals;
  rehearsals.processor_fraction = options.rehearsal_fraction;
  rehearsals.wake = options.wake;
  rehearsals.log = options.log;
  return rehearsals;
}

/// When a path of each task and robot was last retired; nothing if no other server may do that.
std::map<std::pair<std::string, Digest>, std::uint64_t> retired_generations(
    const runtime::RobotRegistry& robots, const store::ExperienceStore& store) {
  constexpr std::size_t kPage = 1000;
  std::map<std::pair<std::string, Digest>, std::uint64_t> retired;
  if (!robots.is_shared())
    return retired;
  std::string cursor;
  do {
    store::Page<TaskSummary> page = store.list_tasks(cursor, kPage);
    for (const TaskSummary& each : page.rows)
      for (const store::ExperienceSummary& robot : store.experience(each.task))
        retired[{each.task, robot.robot}] = robot.retired_generation;
    cursor = std::move(page.next_cursor);
  } while (!cursor.empty());
  return retired;
}

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f s", value);
  return text;
}

}  // namespace

FetchService::FetchService(const ServiceParts& parts, const store::ExperienceStore& store,
                           store::DistributionStore& distributions,
                           store::RehearsalStore& rehearsals, Upstream& upstream)
    : parts_(parts),
      store_(store),
      upstream_(upstream),
      experience_(store, parts.robots, parts.options.experience),
      advice_([&store](const Digest& robot,
                       const std::string& task) { return store.attempt_totals(robot, task); },
              [&distributions](const Digest& id) -> std::optional<catalog::Context> {
                const auto distribution = distributions.find_distribution(id);
                if (!distribution)
                  return std::nullopt;
                return catalog::Context{distribution->engines, distribution->profile};
              },
              [this](std::function<void()> run) {
                return parts_.pools.store.submit(runtime::WorkerPool::Priority::Background,
                                                 {.run = std::move(run), .abandon = {}});
              }),
      memory_(parts.options.fit_memory_bytes),
      fitters_({.threads = parts.options.fit_threads,
                .queue_limit = parts.options.fit_queue,
                .niceness = parts.options.fit_niceness}),
      catalog_({store, distributions, parts.robots, parts.pools.store, fitters_,
                parts.options.clock, &memory_},
               catalog_options()),
      retired_generations_(retired_generations(parts.robots, store)),
      rehearsals_({store, parts.robots, parts.options.clock, experience_, &memory_, &rehearsals},
                  rehearsal_options(parts.options)) {}

catalog::Catalog::Options FetchService::catalog_options() {
  catalog::Catalog::Options catalog;
  catalog.limits = parts_.options.catalog;
  catalog.fit = parts_.options.fit;
  catalog.on_fit = [this](const Distribution& distribution) {
    parts_.measures.count(distribution);
    log_fit(distribution);
    publish_fit(parts_.events, parts_.robots, distribution);
  };
  catalog.on_trouble = [this](const Digest& id, FetchStatus status, const std::string& message) {
    parts_.troubles.add(status == FetchStatus::Busy ? Trouble::FitEnded : Trouble::FitMemory,
                        "distribution " + id.short_hex() + ": " + message);
  };
  catalog.on_over_quota = [this](const std::string& client, catalog::ClientBound bound,
                                 const std::string& message) {
    parts_.clients.count_refusal(client, quota_of(bound));
    parts_.troubles.add(Trouble::FetchQuota, message);
  };
  catalog.announce = [this](Announcement announcement) {
    announcement.store_epoch = store_.epoch();
    parts_.options.on_announcement(announcement);
  };
  catalog.on_unfollowed = parts_.options.on_unfollowed;
  catalog.wake = parts_.options.wake;
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

/// A distribution in memory is the one in the store, also if an epoch began meanwhile.
catalog::FetchDone FetchService::of_this_epoch(catalog::FetchDone done) const {
  return [this, done = std::move(done)](const FetchReply& reply) {
    const Uuid epoch = store_.epoch();
    if (!reply.distribution || reply.distribution->store_epoch == epoch)
      return done(reply);
    FetchReply renewed = reply;
    renewed.distribution->store_epoch = epoch;
    done(renewed);
  };
}

void FetchService::fetch(const FetchRequest& request, const std::string& waiter,
                         catalog::FetchDone done) {
  upstream_.note_task(request.task);
  // Shared by request and answer: they may be on two threads, in either order.
  const auto watch = std::make_shared<FetchWatch>(parts_.options.clock);
  done = [this, watch, client = std::string(catalog::client_of(waiter)),
          done = std::move(done)](const FetchReply& reply) {
    count_fetch(reply);
    parts_.clients.count_reply(client, reply_bytes(reply));
    parts_.measures.count(reply, *watch);
    done(reply);
  };
  done = of_this_epoch(std::move(done));
  if (request.experience_bytes > 0)
    done =
        rehearsal::with_rehearsal(rehearsals_, request, parts_.options.clock.now(),
                                  catalog::with_experience(experience_, request, std::move(done)));
  catalog::FetchDone answer = [watch, done = std::move(done)](const FetchReply& reply) {
    watch->set_answered();
    done(reply);
  };
  if (parts_.options.on_event)  // the request is copied for watchers alone
    answer = [this, request, answer = std::move(answer)](const FetchReply& reply) {
      answer(reply);
      publish_fetch(parts_.events, parts_.robots, request, reply);
    };
  catalog_.fetch(request, waiter, std::move(answer));
  watch->set_asked();
}

void FetchService::refuse(const std::string& why,
                          const std::function<void(const FetchReply&)>& done) {
  FetchReply reply;
  reply.status = FetchStatus::Refused;
  reply.message = why;
  count_fetch(reply);
  done(reply);
}

void FetchService::postpone(const std::string& why,
                            const std::function<void(const FetchReply&)>& done) {
  FetchReply reply;
  reply.status = FetchStatus::Busy;
  reply.message = why;
  reply.retry_after = TaskPools::kRetryAfter;
  count_fetch(reply);
  done(reply);
}

void FetchService::count_fetch(const FetchReply& reply) {
  if (reply.status == FetchStatus::Busy)
    parts_.troubles.add(Trouble::FetchBusy, reply.message);
  else if (reply.status == FetchStatus::Refused)
    parts_.troubles.add(Trouble::FetchRefused, reply.message);
}

void FetchService::log_fit(const Distribution& distribution) const {
  std::uint64_t paths = 0;
  for (const Source& source : distribution.sources)
    paths += source.paths;
  const bool failed = distribution.state == DistributionState::Failed;
  parts_.options.log(
      "fit " + distribution.id.short_hex() + " revision " + std::to_string(distribution.revision) +
      " for robot " + distribution.robot.short_hex() + ", task '" + distribution.task +
      "': " + std::to_string(distribution.configurations) + " configurations from " +
      std::to_string(paths) + " paths, transfer " + seconds(distribution.transfer_time_s) +
      ", fit " + seconds(distribution.fit_time_s) +
      (distribution.fit ? ", " + describe(*distribution.fit) : "") + (failed ? ", failed" : "") +
      (distribution.reason.empty() ? "" : ": " + distribution.reason));
}

void FetchService::take_changes(const store::StoreChanges& changes) {
  for (const Digest& robot : changes.robots)
    if (!parts_.robots.read_again(robot))
      forget_robot(robot);
  std::set<std::string> grown, retired;
  for (const store::ChangedExperience& pair : changes.experience) {
    grown.insert(pair.task);
    advice_.read_again(pair.task, pair.now.robot);
    std::uint64_t& known = retired_generations_[{pair.task, pair.now.robot}];
    if (pair.now.retired_generation > known)
      retired.insert(pair.task);
    known = pair.now.retired_generation;
  }
  for (const std::string& task : changes.former_tasks)
    drop_task(task);
  for (const std::string& task : retired)
    forget_task(task);
  for (const std::string& task : grown)
    if (!retired.contains(task))
      new_experience(task);
  for (const Digest& id : changes.evicted)
    catalog_.evict(id);
}

void FetchService::new_experience(std::string_view task) {
  experience_.new_experience(task);
  rehearsals_.new_experience(task);
  catalog_.new_experience(task);
}

void FetchService::forget(const std::string& task, Loss loss) {
  experience_.forget(task);
  rehearsals_.forget(task, loss);
  catalog_.forget(task);
}

void FetchService::forget_robot(const Digest& robot) {
  catalog_.forget_robot(robot);
  advice_.forget(robot);
}

Advice FetchService::advise(const Distribution& distribution) {
  const Result<Profile> profile = profile_from_text(distribution.profile);
  return advice_.advise(distribution.task, distribution.robot,
                        {distribution.engines, distribution.profile},
                        profile ? fitting::first_share(*profile, distribution.state)
                                : distribution.advice.recommended_share);
}

void FetchService::expire(TimePoint now) {
  catalog_.expire(now);
  rehearsals_.expire(now);
}

void FetchService::stop() {
  catalog_.stop();
  experience_.stop();  // a rehearsal waits for it
  rehearsals_.stop();
}

}  // namespace kinship::service
