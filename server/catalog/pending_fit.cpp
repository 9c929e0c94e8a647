#include "server/catalog/pending_fit.hpp"

#include <algorithm>

#include "server/catalog/freshness.hpp"

namespace kinship::catalog {

void give(const Answers& answers) {
  for (const auto& [done, reply] : answers)
    done(*reply);
}

bool satisfies(const FetchReply& reply, std::uint64_t minimum_generation) {
  return reply.distribution && own_generation(*reply.distribution) >= minimum_generation;
}

void PendingFit::join(Waiter waiter) {
  const auto earlier = std::find_if(waiters_.begin(), waiters_.end(),
                                    [&](const Waiter& other) { return other.key == waiter.key; });
  if (earlier == waiters_.end()) {
    waiters_.push_back(std::move(waiter));
    return;
  }
  if (earlier->deadline && waiter.deadline)
    waiter.deadline = std::min(*earlier->deadline, *waiter.deadline);
  *earlier = std::move(waiter);
}

template <typename Predicate>
void PendingFit::answer_if(Predicate predicate, const SharedReply& reply, Answers& answers) {
  const auto stay = std::stable_partition(waiters_.begin(), waiters_.end(),
                                          [&](const Waiter& waiter) { return !predicate(waiter); });
  for (auto waiter = stay; waiter != waiters_.end(); ++waiter)
    answers.emplace_back(std::move(waiter->done), reply);
  waiters_.erase(stay, waiters_.end());
}

void PendingFit::answer_all(const SharedReply& reply, Answers& answers) {
  answer_if([](const Waiter&) { return true; }, reply, answers);
}

void PendingFit::answer_satisfied(const SharedReply& reply, Answers& answers) {
  answer_if([&](const Waiter& waiter) { return satisfies(*reply, waiter.minimum_generation); },
            reply, answers);
}

void PendingFit::answer_without_deadline(const SharedReply& reply, Answers& answers) {
  answer_if([](const Waiter& waiter) { return !waiter.deadline; }, reply, answers);
}

void PendingFit::answer_expired(std::chrono::steady_clock::time_point now, const SharedReply& reply,
                                Answers& answers) {
  answer_if([now](const Waiter& waiter) { return waiter.deadline && *waiter.deadline <= now; },
            reply, answers);
}

}  // namespace kinship::catalog
