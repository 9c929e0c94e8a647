#include "server/catalog/catalog.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "proto/types/limits.hpp"
#include "server/catalog/fetch_reply.hpp"
#include "server/catalog/freshness.hpp"
#include "server/fitting/selected_experience.hpp"

namespace kinship::catalog {
namespace {

using Stage = Flight::Stage;
using Priority = runtime::WorkerPool::Priority;

constexpr std::chrono::milliseconds kLookRetry(50);  // after the desk had no room
/// Reports that come one by one are not each a reason to ask the store about what is followed.
constexpr std::chrono::milliseconds kLookSpacing(1000);

}  // namespace

Catalog::Catalog(const Parts& parts, Options options)
    : parts_(parts),
      options_(std::move(options)),
      adviser_(options_.advice),
      maker_({.store = parts.store, .robots = parts.robots, .clock = parts.clock}, options_.fit),
      leases_(options_.max_leases),
      memory_(options_.memory) {}

void Catalog::finish(const Afterwards& after) const {
  give(after.answers);
  for (const Digest& id : after.unfollowed)
    options_.on_unfollowed(id);
  if (after.wake)
    options_.wake();
}

void Catalog::fetch(const FetchRequest& request, const std::string& waiter, FetchDone done) {
  ++fetches_;
  const Result<fitting::DistributionKey> key = fitting::make_key(request);
  if (!key)
    return done(without_distribution(FetchStatus::Refused, key.error().message));
  const Digest id = identify(*key);
  // Its own experience says nothing about a distribution that is not made of it.
  Waiter who{waiter, selects(*key, key->robot) ? request.minimum_generation : 0, std::nullopt,
             in_words_of(request, std::move(done))};
  const TimePoint now = parts_.clock.now();
  if (request.deadline.count() > 0)
    who.deadline = now + request.deadline;

  Afterwards after;
  AdvisedReply known;
  FetchDone answer = who.done;
  {
    const std::lock_guard lock(mutex_);
    if (request.follow.count() > 0)
      follow(id, *key, now + std::min(request.follow, std::chrono::seconds(kMaxFollow_s)));
    known = find(id, *key, who.minimum_generation);
    if (!known.reply)
      if (SharedReply reply = join(id, *key, std::move(who)))
        after.answers.emplace_back(answer, std::move(reply));
    tend(id, after);
  }
  if (known.reply && !adviser_.is_current(known, *key)) {
    const AdvisedReply advised = adviser_.advise(known.reply, *key);
    const std::lock_guard lock(mutex_);
    memory_.replace(id, known.reply, advised);
    known = advised;
  }
  if (known.reply)
    after.answers.emplace_back(std::move(answer), std::move(known.reply));
  finish(after);
}

/// Takes or extends a lease; what memory knows about the distribution need not be asked for.
void Catalog::follow(const Digest& id, const fitting::DistributionKey& key, TimePoint until) {
  if (stopping_)
    return;
  leases_.take(id, key, until);
  Leases::Lease* const lease = leases_.find(id);
  const DistributionCache::Entry* const entry = memory_.find(id);
  if (lease != nullptr && !lease->compared && entry != nullptr)
    lease->compared = comparison_of(*entry->reply.reply->distribution, entry->marks, entry->behind);
}

/// What memory holds, if that is an answer. Has it fitted again behind if it is time for that.
AdvisedReply Catalog::find(const Digest& id, const fitting::DistributionKey& key,
                           std::uint64_t generation) {
  if (stopping_)
    return {shared(busy("the server is stopping"))};
  const DistributionCache::Entry* entry = memory_.find(id);
  const Marks marks = marks_.of(key.task);
  if (entry == nullptr || entry->marks.retirements != marks.retirements)
    return {};
  const AdvisedReply reply = entry->reply;
  const bool due = (entry->behind || entry->marks != marks) &&
                   may_refit(*reply.reply->distribution, parts_.clock.unix_ms());
  // A failure that may have been overtaken is no answer; a mixture is, whatever came after it.
  const bool is_answer =
      !(reply.reply->status == FetchStatus::Failed && due) && satisfies(*reply.reply, generation);
  if (due)
    refresh(id, key);
  if (!is_answer)
    return {};
  ++fetches_from_memory_;
  return reply;
}

SharedReply Catalog::join(const Digest& id, const fitting::DistributionKey& key, Waiter waiter) {
  if (flights_.waiters() >= options_.max_waiters)
    return shared(busy("too many wait already"));
  const auto [flight, is_new] = flights_.open(id, key);
  if (flight.stage == Stage::Idle && !begin_look(id, flight)) {
    if (is_new)
      flights_.close(id);
    return shared(busy("the server is busy"));
  }
  flight.is_wanted = true;
  if (flight.stage == Stage::Queued && !flight.urgent)
    begin_fit(id, flight, Priority::Interactive);
  if (flight.stage != Stage::Looking && !waiter.deadline)
    return shared_pending();
  flight.join(std::move(waiter));
  return nullptr;
}

/// \return false if the desk has no room: the next fetch, or the lease, tries again.
bool Catalog::refresh(const Digest& id, const fitting::DistributionKey& key) {
  const auto [flight, is_new] = flights_.open(id, key);
  if (flight.stage != Stage::Idle || begin_look(id, flight))
    return true;
  if (is_new)
    flights_.close(id);
  return false;
}

bool Catalog::begin_look(const Digest& id, Flight& flight) {
  if (Leases::Lease* const lease = leases_.find(id))
    lease->last_look = parts_.clock.now();
  if (!parts_.desk.submit(Priority::Interactive, {.run = [this, id] { look(id); }, .abandon = {}}))
    return false;
  flight.stage = Stage::Looking;
  flight.look_due.reset();
  return true;
}

void Catalog::look_soon(const Digest& id, Flight& flight, Afterwards& after) {
  flight.stage = Stage::Idle;
  if (begin_look(id, flight))
    return;
  flight.look_due = parts_.clock.now() + kLookRetry;
  after.wake = true;
}

bool Catalog::begin_fit(const Digest& id, Flight& flight, Priority priority) {
  if (!parts_.fitters.submit(priority, {.run = [this, id] { run_fit(id); }, .abandon = {}}))
    return false;
  flight.stage = Stage::Queued;
  flight.urgent = priority == Priority::Interactive;
  return true;
}

/// Keeps a reply, and what it was found to be, for fetches and for the lease.
void Catalog::remember(const Digest& id, const AdvisedReply& reply, const Marks& marks,
                       bool behind) {
  memory_.put(id, {.reply = reply, .marks = marks, .behind = behind});
  if (Leases::Lease* const lease = leases_.find(id))
    lease->compared = comparison_of(*reply.reply->distribution, marks, behind);
}

/// When a followed distribution is to be looked at next: a function of what is known about it, so
/// that nothing that arrives while it is looked at or fitted can be missed.
void Catalog::tend(const Digest& id, Afterwards& after) {
  const Leases::Lease* const lease = leases_.find(id);
  if (lease == nullptr)
    return;
  const TimePoint now = parts_.clock.now();
  std::optional<TimePoint> due;
  const std::optional<Comparison>& compared = lease->compared;
  const Marks marks = marks_.of(lease->key.task);
  if (!compared || compared->marks.retirements != marks.retirements)
    due = now;
  else if (compared->behind || compared->marks != marks)
    due = now + (compared->fitted_ms ? until_refit(*compared->fitted_ms, parts_.clock.unix_ms())
                                     : std::chrono::milliseconds(0));
  if (due && lease->last_look)
    due = std::max(*due, *lease->last_look + kLookSpacing);
  const Flight* const flight = flights_.find(id);
  if (flight != nullptr && flight->stage != Stage::Idle)
    due.reset();  // until it rests
  if (leases_.set_due(id, due))
    after.wake = true;
}

std::optional<Catalog::TimePoint> Catalog::next_deadline() const {
  const std::lock_guard lock(mutex_);
  const std::optional<TimePoint> flight = flights_.next_deadline();
  const std::optional<TimePoint> lease = leases_.next_due();
  return flight && lease ? std::min(*flight, *lease) : flight ? flight : lease;
}

void Catalog::expire(TimePoint now) {
  Afterwards after;
  {
    const std::lock_guard lock(mutex_);
    flights_.answer_expired(now, shared_pending(), after.answers);
    for (auto& [id, flight] : flights_)
      if (flight.look_due && *flight.look_due <= now)
        look_soon(id, flight, after);
    leases_.expire(now);
    after.unfollowed = leases_.take_ended();
    for (const Digest& id : leases_.due(now)) {
      refresh(id, leases_.find(id)->key);
      tend(id, after);
    }
    after.wake = false;  // whoever calls this asks for the next deadline anyway
  }
  finish(after);
}

void Catalog::new_experience(std::string_view task) {
  Afterwards after;
  {
    const std::lock_guard lock(mutex_);
    marks_.grew(task);
    look_again(task, after);
  }
  finish(after);
}

void Catalog::forget(std::string_view task) {
  Afterwards after;
  {
    const std::lock_guard lock(mutex_);
    marks_.lost(task);
    look_again(task, after);
  }
  finish(after);
}

/// For those who wait for experience, and for those who follow.
void Catalog::look_again(std::string_view task, Afterwards& after) {
  for (auto& [id, flight] : flights_)
    if (flight.stage == Stage::Idle && flight.key().task == task)
      look_soon(id, flight, after);
  for (const Digest& id : leases_.of_task(task))
    tend(id, after);
}

void Catalog::evict(const Digest& id) {
  maker_.forget(id);
  Afterwards after;
  {
    const std::lock_guard lock(mutex_);
    memory_.erase(id);
    if (Flight* const flight = flights_.find(id))
      flight->was_evicted = true;
    if (Leases::Lease* const lease = leases_.find(id))
      lease->compared.reset();
    tend(id, after);
  }
  finish(after);
}

void Catalog::stop() {
  Afterwards after;
  stop_source_.request_stop();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    flights_.close_all(shared(busy("the server is stopping")), after.answers);
    leases_.end_all();
  }
  finish(after);
}

std::size_t Catalog::followed() const {
  const std::lock_guard lock(mutex_);
  return leases_.count(parts_.clock.now());
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

}  // namespace kinship::catalog
