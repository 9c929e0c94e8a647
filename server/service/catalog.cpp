#include "server/service/catalog.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "server/service/fetch_reply.hpp"
#include "server/service/freshness.hpp"
#include "server/service/selected_experience.hpp"

namespace kinship::service {
namespace {

using Stage = Flight::Stage;
using Priority = WorkerPool::Priority;

constexpr std::chrono::milliseconds kLookRetry(50);  // after the desk had no room

}  // namespace

Catalog::Catalog(const Parts& parts, Options options)
    : parts_(parts),
      options_([&] {
        if (!options.fit)
          options.fit = [parts](const DistributionKey& key, const std::stop_token& stop) {
            return fit_distribution(
                key, {.store = parts.store, .robots = parts.robots, .clock = parts.clock}, stop);
          };
        return std::move(options);
      }()),
      memory_(options_.memory) {}

void Catalog::fetch(const FetchRequest& request, const std::string& waiter, FetchDone done) {
  ++fetches_;
  const Result<DistributionKey> key = make_key(request);
  if (!key)
    return done(without_distribution(FetchStatus::Refused, key.error().message));
  const Digest id = identify(*key);
  Waiter who{waiter, request.minimum_generation, std::nullopt, std::move(done)};
  if (request.deadline.count() > 0)
    who.deadline = parts_.clock.now() + request.deadline;

  Answers answers;
  {
    const std::lock_guard lock(mutex_);
    bool due = false;
    SharedReply reply = find(id, request, due);
    if (reply)
      ++fetches_from_memory_;
    if (reply && due)
      refresh(id, *key);
    FetchDone answer = who.done;
    if (!reply)
      reply = join(id, *key, std::move(who));
    if (reply)
      answers.emplace_back(std::move(answer), std::move(reply));
  }
  give(answers);
}

SharedReply Catalog::find(const Digest& id, const FetchRequest& request, bool& due) {
  if (stopping_)
    return shared(busy("the server is stopping"));
  const DistributionCache::Entry* entry = memory_.find(id);
  if (entry == nullptr)
    return nullptr;
  due = (entry->behind || entry->changes_seen != changes_of(request.task)) &&
        may_refit(*entry->reply->distribution, parts_.clock.unix_ms());
  // A failure that may have been overtaken is no answer; a mixture is, whatever came after it.
  if (entry->reply->status == FetchStatus::Failed && due)
    return nullptr;
  return satisfies(*entry->reply, request.minimum_generation) ? entry->reply : nullptr;
}

SharedReply Catalog::join(const Digest& id, const DistributionKey& key, Waiter waiter) {
  if (waiter_count() >= options_.max_waiters)
    return shared(busy("too many wait already"));
  const auto [found, is_new] = flights_.try_emplace(id, key);
  Flight& flight = found->second;
  if (flight.stage == Stage::Idle && !begin_look(id, flight)) {
    if (is_new)
      flights_.erase(found);
    return shared(busy("the server is busy"));
  }
  if (flight.stage == Stage::Queued && !flight.urgent)
    begin_fit(id, flight, Priority::Interactive);
  if (flight.stage != Stage::Looking && !waiter.deadline)
    return shared_pending();
  flight.join(std::move(waiter));
  return nullptr;
}

void Catalog::refresh(const Digest& id, const DistributionKey& key) {
  const auto [found, is_new] = flights_.try_emplace(id, key);
  if (found->second.stage == Stage::Idle && !begin_look(id, found->second) && is_new)
    flights_.erase(found);  // the next fetch tries again
}

bool Catalog::begin_look(const Digest& id, Flight& flight) {
  if (!parts_.desk.submit(Priority::Interactive, {.run = [this, id] { look(id); }, .abandon = {}}))
    return false;
  flight.stage = Stage::Looking;
  flight.look_due.reset();
  return true;
}

void Catalog::look_soon(const Digest& id, Flight& flight) {
  if (!begin_look(id, flight))
    flight.look_due = parts_.clock.now() + kLookRetry;
}

bool Catalog::begin_fit(const Digest& id, Flight& flight, Priority priority) {
  if (!parts_.fitters.submit(priority, {.run = [this, id] { run_fit(id); }, .abandon = {}}))
    return false;
  flight.stage = Stage::Queued;
  flight.urgent = priority == Priority::Interactive;
  return true;
}

void Catalog::look(const Digest& id) {
  DistributionKey key;
  SharedReply known;
  std::uint64_t changes = 0;
  {
    const std::lock_guard lock(mutex_);
    const auto found = flights_.find(id);
    if (found == flights_.end())
      return;  // stopped
    key = found->second.key();
    changes = changes_of(key.task);
    if (const DistributionCache::Entry* entry = memory_.find(id))
      known = entry->reply;
  }
  try {
    const Result<RobotRegistry::RobotPointer> robot = parts_.robots.find(key.robot);
    if (!robot)
      return end_flight(id, without(robot.error()));
    if (!known)
      if (std::optional<Distribution> stored = parts_.store.find_distribution(id))
        known = with_distribution(std::move(*stored));
    for (const Digest& source : key.sources)
      if (const auto found = parts_.robots.find(source);
          !found && found.error().code == ErrorCode::NotFound)
        return end_flight(id, without_distribution(FetchStatus::Refused,
                                                   "selected source: " + found.error().message));
    const std::vector<store::ExperienceSummary> all = parts_.store.experience(key.task);
    if (known && is_retired(*known->distribution, all))
      known = nullptr;
    const std::vector<store::ExperienceSummary> experience = selected_experience(key, all);
    if (count_paths(experience) == 0 && !known)
      return end_flight(id, no_experience(key));
    settle(id, known, experience, changes);
  } catch (const std::exception& exception) {
    end_flight(id, busy(exception.what()));
  }
}

FetchReply Catalog::without(const Error& robot_error) const {
  switch (robot_error.code) {
    case ErrorCode::NotFound:
      return without_distribution(FetchStatus::UnknownRobot, robot_error.message);
    case ErrorCode::Storage:
      return busy(robot_error.message);
    default:
      return without_distribution(FetchStatus::Refused, robot_error.message);
  }
}

void Catalog::settle(const Digest& id, const SharedReply& known,
                     const std::vector<store::ExperienceSummary>& experience,
                     std::uint64_t changes) {
  Answers answers;
  {
    const std::lock_guard lock(mutex_);
    const auto found = flights_.find(id);
    if (found == flights_.end())
      return;
    Flight& flight = found->second;
    bool refit = false;
    if (known) {
      const Distribution& distribution = *known->distribution;
      const bool behind = is_behind(distribution, experience);
      refit = behind && may_refit(distribution, parts_.clock.unix_ms());
      memory_.put(id, {known, changes, behind});
      if (known->status == FetchStatus::Ready || !refit)
        flight.answer_satisfied(known, answers);
    }
    flight.answer_without_deadline(shared_pending(), answers);

    // A fit helps those whose generation has arrived; the others wait for reports.
    const std::uint64_t generation = generation_of(flight.key().robot, experience);
    const bool urgent = !known || std::any_of(flight.waiters().begin(), flight.waiters().end(),
                                              [generation](const Waiter& waiter) {
                                                return waiter.minimum_generation <= generation;
                                              });
    const bool begun = (urgent || refit) &&
                       begin_fit(id, flight, urgent ? Priority::Interactive : Priority::Background);
    if (urgent && !begun)
      flight.answer_all(shared(busy("too many fits wait already")), answers);
    if (!begun)
      rest(found, changes);
  }
  give(answers);
}

void Catalog::rest(Flights::iterator flight, std::uint64_t changes) {
  if (flight->second.waiters().empty()) {
    flights_.erase(flight);
    return;
  }
  flight->second.stage = Stage::Idle;
  if (changes_of(flight->second.key().task) != changes)
    look_soon(flight->first, flight->second);
}

void Catalog::run_fit(const Digest& id) {
  DistributionKey key;
  std::uint64_t changes = 0;
  {
    const std::lock_guard lock(mutex_);
    const auto found = flights_.find(id);
    // Stopped, or begun by the flight's other job: a background one that became urgent has two.
    if (found == flights_.end() || found->second.stage != Stage::Queued)
      return;
    found->second.stage = Stage::Fitting;
    key = found->second.key();
    changes = changes_of(key.task);
  }
  try {
    FitOutcome outcome = try_fit(key);
    if (outcome.kind == FitOutcome::Kind::Abandoned)
      return end_flight(id, busy("the server is stopping"));
    if (outcome.kind == FitOutcome::Kind::NoExperience)
      return end_flight(id, no_experience(key));
    land(id, keep(std::move(outcome.distribution).value()), changes);
  } catch (const std::exception& exception) {  // the store cannot be read
    end_flight(id, busy(exception.what()));
  }
}

FitOutcome Catalog::try_fit(const DistributionKey& key) const {
  std::string reason;
  try {
    return options_.fit(key, stop_source_.get_token());
  } catch (const Failure& failure) {
    if (failure.code() == ErrorCode::Storage || failure.code() == ErrorCode::Unavailable)
      throw;  // the next attempt may find it well again
    reason = failure.what();
  } catch (const std::exception& exception) {
    reason = exception.what();
  }
  return {FitOutcome::Kind::Fitted,
          failed_distribution(
              key, {.store = parts_.store, .robots = parts_.robots, .clock = parts_.clock},
              "the fit ended: " + reason)};
}

SharedReply Catalog::keep(Distribution distribution) {
  ++fits_;
  try {
    distribution.revision = parts_.store.put_distribution(distribution);
  } catch (const Failure& failure) {  // of use all the same, while this server runs
    distribution.revision = 0;
    distribution.reason += (distribution.reason.empty() ? "not stored: " : "; not stored: ") +
                           std::string(failure.what());
    distribution.reason = cut_text(distribution.reason, kMaxMessageBytes);
  }
  options_.on_fit(distribution);
  return with_distribution(std::move(distribution));
}

void Catalog::land(const Digest& id, const SharedReply& reply, std::uint64_t changes) {
  Answers answers;
  {
    const std::lock_guard lock(mutex_);
    constexpr double kNewShare = 0.25;
    const double fit_s = reply->distribution->transfer_time_s + reply->distribution->fit_time_s;
    typical_fit_s_ = (1 - kNewShare) * typical_fit_s_ + kNewShare * fit_s;
    memory_.put(id, {reply, changes, false});
    const auto found = flights_.find(id);
    if (found == flights_.end())
      return;
    found->second.answer_satisfied(reply, answers);
    rest(found, changes);
  }
  give(answers);
}

void Catalog::end_flight(const Digest& id, const FetchReply& reply) {
  Answers answers;
  {
    const std::lock_guard lock(mutex_);
    const auto found = flights_.find(id);
    if (found == flights_.end())
      return;
    found->second.answer_all(shared(reply), answers);
    flights_.erase(found);
  }
  give(answers);
}

std::optional<Catalog::TimePoint> Catalog::next_deadline() const {
  const std::lock_guard lock(mutex_);
  std::optional<TimePoint> next;
  const auto consider = [&next](const std::optional<TimePoint>& time) {
    if (time && (!next || *time < *next))
      next = time;
  };
  for (const auto& [id, flight] : flights_) {
    consider(flight.look_due);
    for (const Waiter& waiter : flight.waiters())
      consider(waiter.deadline);
  }
  return next;
}

void Catalog::expire(TimePoint now) {
  Answers answers;
  {
    const std::lock_guard lock(mutex_);
    const SharedReply pending = shared_pending();
    for (auto& [id, flight] : flights_)
      flight.answer_expired(now, pending, answers);
    std::erase_if(flights_, [](const auto& entry) {
      return entry.second.stage == Stage::Idle && entry.second.waiters().empty();
    });
    for (auto& [id, flight] : flights_)
      if (flight.look_due && *flight.look_due <= now)
        look_soon(id, flight);
  }
  give(answers);
}

void Catalog::new_experience(std::string_view task) {
  const std::lock_guard lock(mutex_);
  ++changes_[std::string(task)];
  for (auto& [id, flight] : flights_)
    if (flight.stage == Stage::Idle && flight.key().task == task)
      look_soon(id, flight);
}

void Catalog::stop() {
  Answers answers;
  stop_source_.request_stop();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    const SharedReply reply = shared(busy("the server is stopping"));
    for (auto& [id, flight] : flights_)
      flight.answer_all(reply, answers);
    flights_.clear();
  }
  give(answers);
}

std::uint64_t Catalog::changes_of(const std::string& task) const {
  const auto found = changes_.find(task);
  return found == changes_.end() ? 0 : found->second;
}

std::size_t Catalog::waiter_count() const {
  std::size_t count = 0;
  for (const auto& [id, flight] : flights_)
    count += flight.waiters().size();
  return count;
}

FetchReply Catalog::busy(const std::string& message) const {
  constexpr double kLeast_s = 0.2, kMost_s = 30;
  const double rounds = std::ceil(static_cast<double>(parts_.fitters.queued() + 1) /
                                  static_cast<double>(parts_.fitters.threads()));
  FetchReply reply = without_distribution(FetchStatus::Busy, message);
  reply.retry_after = std::chrono::milliseconds(
      std::lround(1000 * std::clamp(rounds * typical_fit_s_, kLeast_s, kMost_s)));
  return reply;
}

}  // namespace kinship::service
