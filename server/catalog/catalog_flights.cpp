#include <algorithm>
#include <utility>

#include "proto/types/failure.hpp"
#include "server/catalog/catalog.hpp"
#include "server/catalog/fetch_reply.hpp"
#include "server/catalog/freshness.hpp"

// The half of the catalog that runs on workers: a flight from its look to its end.
namespace kinship::catalog {
namespace {

using Stage = Flight::Stage;
using Priority = runtime::WorkerPool::Priority;

constexpr int kMostFits = 5;  // in a row, if paths are retired during each

Announcement announcement_of(const Distribution& distribution) {
  return {.distribution_id = distribution.id,
          .task = distribution.task,
          .robot = distribution.robot,
          .revision = distribution.revision,
          .store_epoch = distribution.store_epoch};
}

}  // namespace

void Catalog::look(const Digest& id) {
  fitting::DistributionKey key;
  SharedReply in_memory;
  Marks marks;
  {
    const std::lock_guard lock(mutex_);
    Flight* const flight = flights_.find(id);
    if (flight == nullptr)
      return;  // stopped
    flight->was_evicted = false;
    key = flight->key();
    marks = marks_.of(key.task);
    if (const DistributionCache::Entry* entry = memory_.find(id))
      in_memory = entry->reply.reply;
  }
  try {
    const LookUp found = look_up(id, key, in_memory, parts_.store, parts_.robots);
    settle(id, found, adviser_.advise(found.known, key), marks);
  } catch (const std::exception& exception) {
    end_flight(id, busy(exception.what()), std::nullopt);
  }
}

void Catalog::settle(const Digest& id, const LookUp& found, const AdvisedReply& known,
                     const Marks& marks) {
  Afterwards after;
  {
    const std::lock_guard lock(mutex_);
    Flight* const flight = flights_.find(id);
    if (flight == nullptr)
      return;
    if (flight->was_evicted || marks_.of(flight->key().task).retirements != marks.retirements)
      look_soon(id, *flight, after);  // what was found may not be served any more
    else if (found.end)
      end(id, *flight, *found.end, marks, after);
    else
      settle_flight(id, *flight, found, known, marks, after);
  }
  finish(after);
}

void Catalog::settle_flight(const Digest& id, Flight& flight, const LookUp& found,
                            const AdvisedReply& known, const Marks& marks, Afterwards& after) {
  bool refit = false;
  if (known.reply) {
    const Distribution& distribution = *known.reply->distribution;
    const bool behind = is_behind(distribution, found.experience);
    refit = behind && may_refit(distribution, parts_.clock.unix_ms());
    remember(id, known, marks, behind);
    if (known.reply->status == FetchStatus::Ready || !refit)
      flight.answer_satisfied(known.reply, after.answers);
  }
  flight.answer_without_deadline(shared_pending(), after.answers);

  // A fit helps those whose generation has arrived; the others wait for reports.
  const std::uint64_t generation = generation_of(flight.key().robot, found.experience);
  const bool urgent = (!known.reply && flight.is_wanted) ||
                      std::any_of(flight.waiters().begin(), flight.waiters().end(),
                                  [generation](const Waiter& waiter) {
                                    return waiter.minimum_generation <= generation;
                                  });
  const bool wanted = urgent || refit || !known.reply;
  if (wanted && begin_fit(id, flight, urgent ? Priority::Interactive : Priority::Background))
    return;
  if (urgent)
    flight.answer_all(shared(busy("too many fits wait already")), after.answers);
  rest(id, flight, marks, after);
}

/// A flight has nothing to do until more experience arrives, unless that happened meanwhile.
void Catalog::rest(const Digest& id, Flight& flight, const Marks& marks, Afterwards& after) {
  if (flight.waiters().empty()) {
    flights_.close(id);
  } else {
    flight.stage = Stage::Idle;
    if (marks_.of(flight.key().task) != marks)
      look_soon(id, flight, after);
  }
  tend(id, after);
}

void Catalog::run_fit(const Digest& id) {
  fitting::DistributionKey key;
  {
    const std::lock_guard lock(mutex_);
    Flight* const flight = flights_.find(id);
    // Stopped, or begun by the flight's other job: a background one that became urgent has two.
    if (flight == nullptr || flight->stage != Stage::Queued)
      return;
    flight->stage = Stage::Fitting;
    key = flight->key();
  }
  try {
    Marks marks;
    fitting::FitOutcome outcome = fit(id, key, marks);
    if (outcome.kind == fitting::FitOutcome::Kind::Abandoned)
      return end_flight(id, busy("the server is stopping"), std::nullopt);
    if (outcome.kind == fitting::FitOutcome::Kind::NoExperience)
      return end_flight(id, no_experience(key), marks);
    land(id, key, maker_.keep(std::move(outcome)), marks);
  } catch (const std::exception& exception) {  // the store cannot be read
    end_flight(id, busy(exception.what()), std::nullopt);
  }
}

/// Fits until no path was retired meanwhile.
/// \param marks  receives the marks that the outcome was compared at.
fitting::FitOutcome Catalog::fit(const Digest& id, const fitting::DistributionKey& key,
                                 Marks& marks) {
  for (int i = 0; i < kMostFits; ++i) {
    {
      const std::lock_guard lock(mutex_);
      marks = marks_.of(key.task);
    }
    fitting::FitOutcome outcome = maker_.make(key, stop_source_.get_token());
    if (!outcome.distribution)
      return outcome;
    {
      const std::lock_guard lock(mutex_);
      marks.retirements = marks_.of(key.task).retirements;
      if (Flight* const flight = flights_.find(id))
        flight->was_evicted = false;  // it is stored after that
    }
    if (!maker_.is_outdated(*outcome.distribution))
      return outcome;
  }
  throw Failure(ErrorCode::Unavailable, "paths of task '" + key.task + "' are being retired");
}

void Catalog::land(const Digest& id, const fitting::DistributionKey& key, Distribution distribution,
                   const Marks& marks) {
  ++fits_;
  const Announcement announcement = announcement_of(distribution);
  const double fit_s = distribution.transfer_time_s + distribution.fit_time_s;
  const AdvisedReply reply = adviser_.advise(with_distribution(std::move(distribution)), key);
  bool is_followed = false;
  Afterwards after;
  {
    const std::lock_guard lock(mutex_);
    constexpr double kNewShare = 0.25;
    typical_fit_s_ = (1 - kNewShare) * typical_fit_s_ + kNewShare * fit_s;
    Flight* const flight = flights_.find(id);
    if (flight == nullptr) {
      // stopped
    } else if (marks_.of(key.task).retirements != marks.retirements) {
      look_soon(id, *flight, after);
    } else {
      flight->answer_satisfied(reply.reply, after.answers);
      if (!flight->was_evicted) {
        remember(id, reply, marks, false);
        is_followed = announcement.revision > 0 && leases_.holds(id, parts_.clock.now());
      }
      rest(id, *flight, marks, after);
    }
  }
  options_.on_fit(*reply.reply->distribution);  // whoever is told of it and asks gets it
  finish(after);
  if (is_followed)
    options_.announce(announcement);
}

void Catalog::end_flight(const Digest& id, const FetchReply& reply,
                         const std::optional<Marks>& marks) {
  Afterwards after;
  {
    const std::lock_guard lock(mutex_);
    if (Flight* const flight = flights_.find(id))
      end(id, *flight, reply, marks, after);
  }
  finish(after);
}

/// \param marks  at which there was found to be nothing to fit; empty if that is not known.
void Catalog::end(const Digest& id, Flight& flight, const FetchReply& reply,
                  const std::optional<Marks>& marks, Afterwards& after) {
  flight.answer_all(shared(reply), after.answers);
  flights_.close(id);
  Leases::Lease* const lease = leases_.find(id);
  if (reply.status == FetchStatus::UnknownRobot || reply.status == FetchStatus::Refused)
    leases_.end(id);
  else if (lease != nullptr && marks)
    lease->compared = Comparison{.marks = *marks, .behind = false, .fitted_ms = std::nullopt};
  tend(id, after);
}

}  // namespace kinship::catalog
