#include "server/service/measures.hpp"

namespace kinship::service {
namespace {

std::size_t index_of(auto enumerator) { return static_cast<std::size_t>(enumerator); }

}  // namespace

FetchOutcome FetchWatch::outcome(const FetchReply& reply) const {
  switch (reply.status) {
    case FetchStatus::Ready:
      if (is_at_once_)
        return FetchOutcome::Memory;
      return reply.distribution && reply.distribution->fitted_ms >= began_ms_ ? FetchOutcome::Fitted
                                                                              : FetchOutcome::Store;
    case FetchStatus::Pending:
      return FetchOutcome::Pending;
    case FetchStatus::NoExperience:
      return FetchOutcome::NoExperience;
    case FetchStatus::UnknownRobot:
      return FetchOutcome::UnknownRobot;
    case FetchStatus::Busy:
      return FetchOutcome::Busy;
    case FetchStatus::Refused:
      return FetchOutcome::Refused;
    case FetchStatus::Failed:
      return FetchOutcome::Failed;
  }
  return FetchOutcome::Failed;
}

void Measures::count(const FetchReply& reply, const FetchWatch& watch) noexcept {
  fetches[index_of(watch.outcome(reply))].observe(watch.age());
}

void Measures::count(std::span<const Receipt> batch,
                     std::chrono::steady_clock::duration age) noexcept {
  receipts.observe(age);
  for (const Receipt& receipt : batch)
    attempts[index_of(receipt.status)].add();
}

void Measures::count(const Distribution& fitted) noexcept {
  if (fitted.state == DistributionState::Failed)
    return failed_fits.add();
  transfers.observe(fitted.transfer_time_s);
  fits.observe(fitted.fit_time_s);
}

void Measures::count(const Job& ended) noexcept {
  if (ended.state >= JobState::Done)
    jobs[index_of(ended.state) - index_of(JobState::Done)].add();
}

}  // namespace kinship::service
