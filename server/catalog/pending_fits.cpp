#include "server/catalog/pending_fits.hpp"

#include <algorithm>

namespace kinship::catalog {

PendingFit* PendingFits::find(const Digest& id) {
  const auto found = pending_.find(id);
  return found == pending_.end() ? nullptr : &found->second;
}

std::pair<PendingFit&, bool> PendingFits::open(const Digest& id,
                                               const fitting::DistributionKey& key) {
  const auto [pending, is_new] = pending_.try_emplace(id, key);
  return {pending->second, is_new};
}

void PendingFits::close_all(const SharedReply& reply, Answers& answers) {
  for (auto& [id, pending] : pending_)
    pending.answer_all(reply, answers);
  pending_.clear();
}

void PendingFits::answer_expired(TimePoint now, const SharedReply& reply, Answers& answers) {
  for (auto& [id, pending] : pending_)
    pending.answer_expired(now, reply, answers);
  std::erase_if(pending_, [](const auto& entry) {
    return entry.second.stage == PendingFit::Stage::Idle && entry.second.waiters().empty();
  });
}

std::size_t PendingFits::waiters() const {
  std::size_t count = 0;
  for (const auto& [id, pending] : pending_)
    count += pending.waiters().size();
  return count;
}

std::size_t PendingFits::waiters_of(std::string_view client) const {
  std::size_t count = 0;
  for (const auto& [id, pending] : pending_)
    count += static_cast<std::size_t>(std::ranges::count_if(
        pending.waiters(),
        [client](const Waiter& waiter) { return client_of(waiter.key) == client; }));
  return count;
}

std::size_t PendingFits::fits_of(std::string_view client) const {
  return static_cast<std::size_t>(std::ranges::count_if(pending_, [client](const auto& entry) {
    return entry.second.client == client && entry.second.stage != PendingFit::Stage::Idle;
  }));
}

void PendingFits::add_to(std::map<std::string, ClientHolds>& holds) const {
  for (const auto& [id, pending] : pending_) {
    for (const Waiter& waiter : pending.waiters())
      ++holds[std::string(client_of(waiter.key))].waiters;
    if (pending.stage != PendingFit::Stage::Idle && !pending.client.empty())
      ++holds[pending.client].fits;
  }
}

std::optional<PendingFits::TimePoint> PendingFits::next_deadline() const {
  std::optional<TimePoint> next;
  const auto consider = [&next](const std::optional<TimePoint>& time) {
    if (time && (!next || *time < *next))
      next = time;
  };
  for (const auto& [id, pending] : pending_) {
    consider(pending.look_up_due);
    for (const Waiter& waiter : pending.waiters())
      consider(waiter.deadline);
  }
  return next;
}

}  // namespace kinship::catalog
