#include "server/catalog/catalog.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "proto/types/failure.hpp"
#include "proto/types/limits.hpp"
#include "server/catalog/fetch_reply.hpp"
#include "server/catalog/fit_turn.hpp"
#include "server/catalog/freshness.hpp"
#include "server/fitting/selected_experience.hpp"

namespace kinship::catalog {
namespace {

using Priority = runtime::WorkerPool::Priority;

constexpr int kMaxFits = 5;  // in a row, if paths are retired during each

Announcement announcement_of(const Distribution& distribution) {
  return {.distribution_id = distribution.id,
          .task = distribution.task,
          .robot = distribution.robot,
          .revision = distribution.revision,
          .store_epoch = distribution.store_epoch};
}

}  // namespace

Catalog::Catalog(const Parts& parts, Options options)
    : parts_(parts),
      options_(std::move(options)),
      adviser_(options_.advice),
      maker_({.store = parts.store,
              .distributions = parts.distributions,
              .robots = parts.robots,
              .clock = parts.clock,
              .memory = parts.memory},
             options_.fit),
      nearest_tasks_(parts.store, parts.clock),
      state_(parts.clock, options_.limits, work()) {}

CatalogState::Work Catalog::work() {
  return {.look_up =
              [this](const Digest& id, const std::string& client) {
                return parts_.short_task_pool.submit(
                    Priority::Interactive,
                    {.run = [this, id] { look_up(id); }, .abandon = {}, .client = client});
              },
          .fit =
              [this](const Digest& id, Priority priority, const std::string& client) {
                return parts_.fitters.submit(
                    priority,
                    {.run = [this, id] { run_fit(id); }, .abandon = {}, .client = client});
              },
          .busy = [this](const std::string& message) { return busy(message); },
          .over_quota =
              [this](const std::string& client, ClientBound bound, const std::string& message) {
                options_.on_over_quota(client, bound, message);
              }};
}

template <typename Change>
void Catalog::change(Change change) {
  Afterwards after;
  {
    const std::lock_guard lock(mutex_);
    change(after);
  }
  finish(after);
}

void Catalog::finish(const Afterwards& after) const {
  give(after.answers);
  for (const Digest& id : after.used)
    parts_.distributions.note_use(id);
  for (const Digest& id : after.unfollowed)
    options_.on_unfollowed(id);
  if (after.wake)
    options_.wake();
}

void Catalog::fetch(const FetchRequest& request, const std::string& waiter, FetchDone done) {
  ++fetches_;
  const Result<fitting::DistributionKey> key =
      fitting::make_key(request, parts_.robots.geometry_revision(request.robot));
  if (!key)
    return done(without_distribution(FetchStatus::Refused, key.error().message));
  const Digest id = identify(*key);
  const FetchDone answer = with_profile_text_of(request, std::move(done));
  // Its own experience says nothing about a distribution that is not made of it.
  Waiter who{waiter, selects(*key, key->robot) ? request.minimum_generation : 0, std::nullopt,
             answer};
  const TimePoint now = parts_.clock.now();
  if (request.deadline.count() > 0)
    who.deadline = now + request.deadline;
  std::optional<TimePoint> follow_until;
  if (request.follow.count() > 0)
    follow_until = now + std::min(request.follow, std::chrono::seconds(kMaxFollow_s));

  AdvisedReply known;
  change([&](Afterwards& after) {
    known = state_.fetch(id, *key, std::move(who), follow_until, after);
  });
  const bool is_from_memory = known.reply && known.reply->status != FetchStatus::Busy;
  ++(is_from_memory ? fetches_from_memory_ : fetches_not_from_memory_);
  if (!known.reply)
    return;
  if (!adviser_.is_current(known, *key)) {
    const AdvisedReply advised = adviser_.advise(known.reply, *key);
    const std::lock_guard lock(mutex_);
    state_.replace(id, known.reply, advised);
    known = advised;
  }
  answer(*known.reply);
}

std::optional<Catalog::TimePoint> Catalog::next_deadline() const {
  const std::lock_guard lock(mutex_);
  return state_.next_deadline();
}

void Catalog::expire(TimePoint now) {
  change([&](Afterwards& after) { state_.expire(now, after); });
}

void Catalog::new_experience(std::string_view task) {
  change([&](Afterwards& after) { state_.add_experience(task, after); });
}

void Catalog::forget(std::string_view task) {
  change([&](Afterwards& after) { state_.retire_experience(task, after); });
}

void Catalog::evict(const Digest& id) {
  maker_.forget(id);
  change([&](Afterwards& after) { state_.evict(id, after); });
}

void Catalog::forget_robot(const Digest& robot) {
  std::vector<Digest> ids;
  change([&](Afterwards& after) { ids = state_.forget_robot(robot, after); });
  for (const Digest& id : ids)
    maker_.forget(id);
}

void Catalog::stop() {
  stop_source_.request_stop();
  change([&](Afterwards& after) { state_.stop(after); });
}

std::size_t Catalog::followed() const {
  const std::lock_guard lock(mutex_);
  return state_.followed();
}

CatalogUse Catalog::use() const {
  const std::lock_guard lock(mutex_);
  return {.waiters = state_.waiters(),
          .holds = state_.holds(),
          .in_memory = state_.memory().size(),
          .memory_bytes = state_.memory().bytes(),
          .dropped = state_.memory().dropped(),
          .fit_memory_bytes = maker_.memory_bytes()};
}

std::map<std::string, ClientHolds> Catalog::holds_of_clients() const {
  const std::lock_guard lock(mutex_);
  return state_.holds_of_clients();
}

std::string Catalog::trouble_of(const Digest& id) const {
  const std::lock_guard lock(mutex_);
  return state_.trouble_of(id);
}

void Catalog::look_up(const Digest& id) {
  std::optional<CatalogState::LookUpInput> input;
  change([&](Afterwards&) { input = state_.begin_look_up(id); });
  if (!input)
    return;
  try {
    LookUp found = catalog::look_up(id, input->key, input->in_memory, parts_.store,
                                    parts_.distributions, parts_.robots);
    if (found.has_no_paths)
      found.end = no_experience(input->key, nearest_tasks_.find(input->key.task));
    const AdvisedReply known = adviser_.advise(found.known, input->key);
    change([&](Afterwards& after) { state_.resolve(id, found, known, input->version, after); });
  } catch (const std::exception& exception) {
    end(id, busy(exception.what()), std::nullopt);
  }
}

void Catalog::run_fit(const Digest& id) {
  std::optional<fitting::DistributionKey> key;
  change([&](Afterwards&) { key = state_.begin_fit(id); });
  if (!key)
    return;
  try {
    const FitTurn turn(parts_.distributions, id, stop_source_.get_token());
    ExperienceVersion version;
    if (turn.has_others()) {
      change([&](Afterwards&) { version = state_.version_of(key->task); });
      if (std::optional<Distribution> made = made_elsewhere(id, *key))
        return complete(id, *key, std::move(*made), version, MadeBy::Another);
    }
    fitting::FitOutcome outcome = fit(id, *key, version);
    if (outcome.kind == fitting::FitOutcome::Kind::Abandoned)
      return end(id, busy("the server is stopping"), std::nullopt);
    if (outcome.kind == fitting::FitOutcome::Kind::NoExperience)
      return end(id, no_experience(*key), version);
    complete(id, *key, maker_.keep(std::move(outcome), turn.right()), version, MadeBy::This);
  } catch (const Failure& failure) {
    fail(id, failure.code() == ErrorCode::TooLarge ? FetchStatus::Refused : FetchStatus::Busy,
         failure.what());
  } catch (const std::exception& exception) {  // no memory for its reply
    fail(id, FetchStatus::Busy, exception.what());
  }
}

void Catalog::fail(const Digest& id, FetchStatus status, const std::string& message) {
  options_.on_trouble(id, status, message);
  change([&](Afterwards& after) { state_.fail(id, status, message, after); });
}

/// Fits until no path was retired meanwhile.
/// \param version  receives the version that the outcome was compared at.
fitting::FitOutcome Catalog::fit(const Digest& id, const fitting::DistributionKey& key,
                                 ExperienceVersion& version) {
  for (int i = 0; i < kMaxFits; ++i) {
    change([&](Afterwards&) { version = state_.version_of(key.task); });
    fitting::FitOutcome outcome = maker_.make(key, stop_source_.get_token());
    if (!outcome.distribution)
      return outcome;
    change([&](Afterwards&) { state_.set_stored(id, key.task, version); });
    if (!maker_.is_outdated(*outcome.distribution))
      return outcome;
  }
  throw Failure(ErrorCode::Unavailable, "paths of task '" + key.task + "' are being retired");
}

/// The distribution that another server has stored, if a fit would bring nothing new.
std::optional<Distribution> Catalog::made_elsewhere(const Digest& id,
                                                    const fitting::DistributionKey& key) {
  const LookUp found =
      catalog::look_up(id, key, nullptr, parts_.store, parts_.distributions, parts_.robots);
  if (found.end || !found.known || has_changed(*found.known->distribution, found.experience))
    return std::nullopt;
  return found.known->distribution;
}

void Catalog::complete(const Digest& id, const fitting::DistributionKey& key,
                       Distribution distribution, const ExperienceVersion& version,
                       MadeBy made_by) {
  const Announcement announcement = announcement_of(distribution);
  const double fit_s = distribution.transfer_time_s + distribution.fit_time_s;
  const AdvisedReply reply = adviser_.advise(with_distribution(std::move(distribution)), key);
  bool is_followed = false;
  Afterwards after;
  {
    const std::lock_guard lock(mutex_);
    constexpr double kNewShare = 0.25;
    if (made_by == MadeBy::This)
      typical_fit_s_ = (1 - kNewShare) * typical_fit_s_ + kNewShare * fit_s;
    is_followed = state_.complete(id, key.task, reply, version, after);
  }
  if (made_by == MadeBy::This) {
    ++fits_;
    options_.on_fit(*reply.reply->distribution);  // a fetch caused by it gets the distribution
  }
  finish(after);
  if (is_followed && announcement.revision > 0)
    options_.announce(announcement);
}

void Catalog::end(const Digest& id, const FetchReply& reply,
                  const std::optional<ExperienceVersion>& version) {
  change([&](Afterwards& after) { state_.end(id, reply, version, after); });
}

FetchReply Catalog::busy(const std::string& message) const {
  constexpr double kMin_s = 0.2, kMax_s = 30;
  const double rounds = std::ceil(static_cast<double>(parts_.fitters.queued() + 1) /
                                  static_cast<double>(parts_.fitters.threads()));
  FetchReply reply = without_distribution(FetchStatus::Busy, message);
  reply.retry_after = std::chrono::milliseconds(
      std::lround(1000 * std::clamp(rounds * typical_fit_s_, kMin_s, kMax_s)));
  return reply;
}

}  // namespace kinship::catalog
