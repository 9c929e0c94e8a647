#include "server/catalog/catalog_state.hpp"

#include <algorithm>
#include <utility>

#include "server/catalog/fetch_reply.hpp"
#include "server/catalog/freshness.hpp"

namespace kinship::catalog {
namespace {

using Stage = PendingFit::Stage;

constexpr std::chrono::milliseconds kLookUpRetry(50);  // after there was no room for one
/// Not every single report causes a look-up of the followed distributions.
constexpr std::chrono::milliseconds kLookUpSpacing(1000);
constexpr std::chrono::hours kBetweenNotes(1);  // of the uses of a distribution, to the store

}  // namespace

CatalogState::CatalogState(const runtime::Clock& clock, const Limits& limits, Work work)
    : clock_(clock),
      limits_(limits),
      work_(std::move(work)),
      leases_(limits.max_leases, limits.client_leases),
      memory_(limits.memory) {}

AdvisedReply CatalogState::fetch(const Digest& id, const fitting::DistributionKey& key,
                                 Waiter waiter, std::optional<TimePoint> follow_until,
                                 Afterwards& after) {
  const std::string client(client_of(waiter.key));
  if (follow_until && !follow(id, key, *follow_until, client))
    return {over_quota(client, ClientBound::Leases,
                       "follows " + std::to_string(limits_.client_leases) + " distributions",
                       limits_.client_leases)};
  AdvisedReply known = find(id, key, waiter.minimum_generation, after);
  if (!known.reply) {
    FetchDone done = waiter.done;
    if (SharedReply reply = join(id, key, std::move(waiter)))
      after.answers.emplace_back(std::move(done), std::move(reply));
  }
  schedule(id, after);
  return known;
}

/// Takes or extends a lease; a comparison in memory saves a look-up.
/// \return false if the client has as many leases as one may have.
bool CatalogState::follow(const Digest& id, const fitting::DistributionKey& key, TimePoint until,
                          const std::string& client) {
  if (stopping_)
    return true;
  if (!leases_.take(id, key, until, client))
    return false;
  Leases::Lease* const lease = leases_.find(id);
  const DistributionCache::Entry* const entry = memory_.find(id);
  if (lease != nullptr && !lease->compared && entry != nullptr)
    lease->compared =
        comparison_of(*entry->reply.reply->distribution, entry->version, entry->behind);
  return true;
}

SharedReply CatalogState::over_quota(const std::string& client, ClientBound bound,
                                     const std::string& what, std::size_t limit) const {
  const std::string message = "this client " + what + " already, the most one client may have (" +
                              std::to_string(limit) + ")";
  work_.over_quota(client, bound, message);
  return shared(work_.busy(message));
}

std::map<std::string, ClientHolds> CatalogState::holds_of_clients() const {
  std::map<std::string, ClientHolds> holds;
  pending_.add_to(holds);
  leases_.add_to(holds);
  return holds;
}

/// The reply in memory, if it is an answer. Has it fitted again in the background if that is due.
AdvisedReply CatalogState::find(const Digest& id, const fitting::DistributionKey& key,
                                std::uint64_t generation, Afterwards& after) {
  if (stopping_)
    return {shared(work_.busy("the server is stopping"))};
  DistributionCache::Entry* entry = memory_.find(id);
  const ExperienceVersion version = versions_.of(key.task);
  if (entry == nullptr || entry->version.retirements != version.retirements)
    return {};
  const TimePoint now = clock_.now();
  if (entry->noted == TimePoint() || now - entry->noted > kBetweenNotes) {
    entry->noted = now;
    after.used.push_back(id);
  }
  const AdvisedReply reply = entry->reply;
  const bool due = (entry->behind || entry->version != version) &&
                   may_refit(*reply.reply->distribution, clock_.unix_ms()) &&
                   troubles_.find(id, clock_.now()) == nullptr;
  // A failure that may have been overtaken is no answer; a mixture is, whatever came after it.
  const bool is_answer =
      !(reply.reply->status == FetchStatus::Failed && due) && satisfies(*reply.reply, generation);
  if (due)
    refresh(id, key);
  return is_answer ? reply : AdvisedReply{};
}

SharedReply CatalogState::join(const Digest& id, const fitting::DistributionKey& key,
                               Waiter waiter) {
  if (pending_.waiters() >= limits_.max_waiters)
    return shared(work_.busy("too many wait already"));
  const std::string client(client_of(waiter.key));
  if (limits_.client_waiters > 0 && pending_.waiters_of(client) >= limits_.client_waiters)
    return over_quota(client, ClientBound::Waiters,
                      "waits for " + std::to_string(limits_.client_waiters) + " replies",
                      limits_.client_waiters);
  const auto [pending, is_new] = pending_.open(id, key);
  if (is_new && limits_.client_fits > 0 && pending_.fits_of(client) >= limits_.client_fits) {
    pending_.close(id);
    return over_quota(client, ClientBound::Fits,
                      "has " + std::to_string(limits_.client_fits) + " fits under way",
                      limits_.client_fits);
  }
  if (is_new)
    pending.client = client;
  if (pending.stage == Stage::Idle && !request_look_up(id, pending)) {
    if (is_new)
      pending_.close(id);
    return shared(work_.busy("the server is busy"));
  }
  pending.is_wanted = true;
  if (pending.stage == Stage::Queued && !pending.urgent)
    request_fit(id, pending, Priority::Interactive);
  if (pending.stage != Stage::LookingUp && !waiter.deadline)
    return shared_pending();
  pending.join(std::move(waiter));
  return nullptr;
}

/// \return false if there is no room for a look-up: the next fetch, or the lease, tries again.
bool CatalogState::refresh(const Digest& id, const fitting::DistributionKey& key) {
  const auto [pending, is_new] = pending_.open(id, key);
  if (pending.stage != Stage::Idle || request_look_up(id, pending))
    return true;
  if (is_new)
    pending_.close(id);
  return false;
}

bool CatalogState::request_look_up(const Digest& id, PendingFit& pending) {
  if (Leases::Lease* const lease = leases_.find(id))
    lease->last_look_up = clock_.now();
  if (!work_.look_up(id, pending.client))
    return false;
  pending.stage = Stage::LookingUp;
  pending.look_up_due.reset();
  return true;
}

void CatalogState::look_up_soon(const Digest& id, PendingFit& pending, Afterwards& after) {
  pending.stage = Stage::Idle;
  if (request_look_up(id, pending))
    return;
  pending.look_up_due = clock_.now() + kLookUpRetry;
  after.wake = true;
}

bool CatalogState::request_fit(const Digest& id, PendingFit& pending, Priority priority) {
  if (!work_.fit(id, priority, pending.client))
    return false;
  pending.stage = Stage::Queued;
  pending.urgent = priority == Priority::Interactive;
  return true;
}

/// Keeps a reply, and its comparison with the experience, for fetches and for the lease.
void CatalogState::remember(const Digest& id, const AdvisedReply& reply,
                            const ExperienceVersion& version, bool behind) {
  memory_.put(id, {.reply = reply, .version = version, .behind = behind});
  if (Leases::Lease* const lease = leases_.find(id))
    lease->compared = comparison_of(*reply.reply->distribution, version, behind);
}

/// When a followed distribution is to be looked up next: a function of its known state, so that no
/// arrival during a look-up or fit can be missed.
void CatalogState::schedule(const Digest& id, Afterwards& after) {
  const Leases::Lease* const lease = leases_.find(id);
  if (lease == nullptr)
    return;
  const TimePoint now = clock_.now();
  std::optional<TimePoint> due;
  const std::optional<Comparison>& compared = lease->compared;
  const ExperienceVersion version = versions_.of(lease->key.task);
  if (!compared || compared->version.retirements != version.retirements)
    due = now;
  else if (compared->behind || compared->version != version)
    due = now + (compared->fitted_ms ? until_refit(*compared->fitted_ms, clock_.unix_ms())
                                     : std::chrono::milliseconds(0));
  if (due && lease->last_look_up)
    due = std::max(*due, *lease->last_look_up + kLookUpSpacing);
  const FitTrouble* const trouble = troubles_.find(id, now);
  if (due && trouble != nullptr)
    due = std::max(*due, trouble->next_try);
  const PendingFit* const pending = pending_.find(id);
  if (pending != nullptr && pending->stage != Stage::Idle)
    due.reset();  // until it is idle
  if (leases_.set_due(id, due))
    after.wake = true;
}

std::optional<CatalogState::TimePoint> CatalogState::next_deadline() const {
  const std::optional<TimePoint> pending = pending_.next_deadline();
  const std::optional<TimePoint> lease = leases_.next_due();
  return pending && lease ? std::min(*pending, *lease) : pending ? pending : lease;
}

void CatalogState::expire(TimePoint now, Afterwards& after) {
  pending_.answer_expired(now, shared_pending(), after.answers);
  for (auto& [id, pending] : pending_)
    if (pending.look_up_due && *pending.look_up_due <= now)
      look_up_soon(id, pending, after);
  leases_.expire(now);
  after.unfollowed = leases_.take_ended();
  for (const Digest& id : leases_.due(now)) {
    refresh(id, leases_.find(id)->key);
    schedule(id, after);
  }
  after.wake = false;  // the caller asks for the next deadline anyway
}

void CatalogState::add_experience(std::string_view task, Afterwards& after) {
  versions_.grew(task);
  look_up_again(task, after);
}

void CatalogState::retire_experience(std::string_view task, Afterwards& after) {
  versions_.lost(task);
  look_up_again(task, after);
}

/// For fetches that wait for experience, and for followers.
void CatalogState::look_up_again(std::string_view task, Afterwards& after) {
  for (auto& [id, pending] : pending_)
    if (pending.stage == Stage::Idle && pending.key().task == task)
      look_up_soon(id, pending, after);
  for (const Digest& id : leases_.of_task(task))
    schedule(id, after);
}

void CatalogState::evict(const Digest& id, Afterwards& after) {
  memory_.erase(id);
  troubles_.erase(id);
  if (PendingFit* const pending = pending_.find(id))
    pending->was_evicted = true;
  if (Leases::Lease* const lease = leases_.find(id))
    lease->compared.reset();
  schedule(id, after);
}

std::vector<Digest> CatalogState::forget_robot(const Digest& robot, Afterwards& after) {
  std::vector<Digest> ids = memory_.of_robot(robot);
  for (const auto& [id, pending] : pending_)
    if (pending.key().robot == robot)
      ids.push_back(id);
  for (const Digest& id : leases_.of_robot(robot))
    ids.push_back(id);
  for (const Digest& id : ids)  // some twice, to no effect
    evict(id, after);
  return ids;
}

void CatalogState::stop(Afterwards& after) {
  stopping_ = true;
  pending_.close_all(shared(work_.busy("the server is stopping")), after.answers);
  leases_.end_all();
}

std::optional<CatalogState::LookUpInput> CatalogState::begin_look_up(const Digest& id) {
  PendingFit* const pending = pending_.find(id);
  if (pending == nullptr)
    return std::nullopt;
  pending->was_evicted = false;
  const DistributionCache::Entry* const entry = memory_.find(id);
  return LookUpInput{pending->key(), entry == nullptr ? nullptr : entry->reply.reply,
                     versions_.of(pending->key().task)};
}

void CatalogState::resolve(const Digest& id, const LookUp& found, const AdvisedReply& known,
                           const ExperienceVersion& version, Afterwards& after) {
  PendingFit* const pending = pending_.find(id);
  if (pending == nullptr)
    return;
  if (pending->was_evicted || versions_.of(pending->key().task).retirements != version.retirements)
    look_up_soon(id, *pending, after);  // the one found may not be served any more
  else if (found.end)
    end(id, *found.end, version, after);
  else
    resolve_pending(id, *pending, found, known, version, after);
}

void CatalogState::resolve_pending(const Digest& id, PendingFit& pending, const LookUp& found,
                                   const AdvisedReply& known, const ExperienceVersion& version,
                                   Afterwards& after) {
  bool refit = false;
  if (known.reply) {
    const Distribution& distribution = *known.reply->distribution;
    const bool behind = is_behind(distribution, found.experience);
    refit = behind && may_refit(distribution, clock_.unix_ms());
    remember(id, known, version, behind);
    if (known.reply->status == FetchStatus::Ready || !refit)
      pending.answer_satisfied(known.reply, after.answers);
  }
  const FitTrouble* const trouble = troubles_.find(id, clock_.now());
  pending.answer_without_deadline(
      trouble == nullptr ? shared_pending() : shared(reply_in(*trouble)), after.answers);

  // A fit helps waiters whose generation has arrived; the others wait for reports.
  const std::uint64_t generation = generation_of(pending.key().robot, found.experience);
  const bool urgent = (!known.reply && pending.is_wanted) ||
                      std::any_of(pending.waiters().begin(), pending.waiters().end(),
                                  [generation](const Waiter& waiter) {
                                    return waiter.minimum_generation <= generation;
                                  });
  const bool wanted = urgent || refit || !known.reply;
  if (wanted && trouble == nullptr &&
      request_fit(id, pending, urgent ? Priority::Interactive : Priority::Background))
    return;
  if (urgent)
    pending.answer_all(
        shared(trouble == nullptr ? work_.busy("too many fits wait already") : reply_in(*trouble)),
        after.answers);
  idle(id, pending, version, after);
}

/// There is nothing to do until more experience arrives, unless that happened meanwhile.
void CatalogState::idle(const Digest& id, PendingFit& pending, const ExperienceVersion& version,
                        Afterwards& after) {
  if (pending.waiters().empty()) {
    pending_.close(id);
  } else {
    pending.stage = Stage::Idle;
    if (versions_.of(pending.key().task) != version)
      look_up_soon(id, pending, after);
  }
  schedule(id, after);
}

std::optional<fitting::DistributionKey> CatalogState::begin_fit(const Digest& id) {
  PendingFit* const pending = pending_.find(id);
  // A background fit that became urgent has two jobs.
  if (pending == nullptr || pending->stage != Stage::Queued)
    return std::nullopt;
  pending->stage = Stage::Fitting;
  return pending->key();
}

void CatalogState::set_stored(const Digest& id, std::string_view task, ExperienceVersion& version) {
  version.retirements = versions_.of(task).retirements;
  if (PendingFit* const pending = pending_.find(id))
    pending->was_evicted = false;
}

bool CatalogState::complete(const Digest& id, std::string_view task, const AdvisedReply& reply,
                            const ExperienceVersion& version, Afterwards& after) {
  troubles_.erase(id);
  PendingFit* const pending = pending_.find(id);
  if (pending == nullptr)
    return false;
  if (versions_.of(task).retirements != version.retirements) {
    look_up_soon(id, *pending, after);
    return false;
  }
  pending->answer_satisfied(reply.reply, after.answers);
  bool is_followed = false;
  if (!pending->was_evicted) {
    remember(id, reply, version, false);
    is_followed = leases_.holds(id, clock_.now());
  }
  idle(id, *pending, version, after);
  return is_followed;
}

void CatalogState::fail(const Digest& id, FetchStatus status, const std::string& message,
                        Afterwards& after) {
  const FitTrouble& trouble = troubles_.add(id, clock_.now(), status, message);
  PendingFit* const pending = pending_.find(id);
  if (pending == nullptr)
    return;
  pending->answer_all(shared(reply_in(trouble)), after.answers);
  pending_.close(id);
  schedule(id, after);
}

FetchReply CatalogState::reply_in(const FitTrouble& trouble) const {
  if (trouble.status != FetchStatus::Busy)
    return without_distribution(trouble.status, trouble.message);
  FetchReply reply = work_.busy(trouble.message);
  reply.retry_after =
      std::max(reply.retry_after,
               std::chrono::ceil<std::chrono::milliseconds>(trouble.next_try - clock_.now()));
  return reply;
}

std::string CatalogState::trouble_of(const Digest& id) const {
  const FitTrouble* const trouble = troubles_.last(id);
  if (trouble == nullptr)
    return {};
  const auto left =
      std::chrono::ceil<std::chrono::seconds>(trouble->next_try - clock_.now()).count();
  return "the last fit made nothing (" + std::to_string(trouble->failures) +
         (trouble->failures == 1 ? " time" : " times in a row") + "): " + trouble->message +
         (left > 0 ? "; it is not tried again for " + std::to_string(left) + " s" : "");
}

void CatalogState::end(const Digest& id, const FetchReply& reply,
                       const std::optional<ExperienceVersion>& version, Afterwards& after) {
  PendingFit* const pending = pending_.find(id);
  if (pending == nullptr)
    return;
  pending->answer_all(shared(reply), after.answers);
  pending_.close(id);
  Leases::Lease* const lease = leases_.find(id);
  if (reply.status == FetchStatus::UnknownRobot || reply.status == FetchStatus::Refused)
    leases_.end(id);
  else if (lease != nullptr && version)
    lease->compared = Comparison{.version = *version, .behind = false, .fitted_ms = std::nullopt};
  schedule(id, after);
}

}  // namespace kinship::catalog
