#include "server/catalog/distribution_maker.hpp"

#include <algorithm>
#include <new>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "server/catalog/freshness.hpp"

namespace kinship::catalog {
namespace {

/// An error that is not due to the experience: a later try may succeed.
bool may_pass(ErrorCode code) {
  return code == ErrorCode::Storage || code == ErrorCode::Unavailable ||
         code == ErrorCode::TooLarge;
}

/// As many as the machine runs at once: fits are at low priority, and rarely many.
int fit_threads() {
  constexpr unsigned kMax = 8;
  return static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, kMax));
}

}  // namespace

DistributionMaker::DistributionMaker(const Parts& parts, Fit fit)
    : parts_(parts),
      fit_(fit ? std::move(fit)
               : [this](const fitting::DistributionKey& key, const std::stop_token& stop) {
                   return fit_distribution(key,
                                           {.store = parts_.store,
                                            .robots = parts_.robots,
                                            .clock = parts_.clock,
                                            .fit_threads = fit_threads(),
                                            .before = memory_.find(identify(key)),
                                            .memory = parts_.memory,
                                            .targets = &targets_},
                                           stop);
                 }) {}

fitting::FitOutcome DistributionMaker::make(const fitting::DistributionKey& key,
                                            const std::stop_token& stop) const {
  std::string reason;
  try {
    return fit_(key, stop);
  } catch (const Failure& failure) {
    if (may_pass(failure.code()))
      throw;
    reason = failure.what();
  } catch (const std::bad_alloc&) {
    throw Failure(ErrorCode::Unavailable, "the fit found no memory");
  } catch (const std::system_error& error) {  // no thread
    throw Failure(ErrorCode::Unavailable, std::string("the fit could not go on: ") + error.what());
  } catch (const std::exception& exception) {
    reason = exception.what();
  }
  return {fitting::FitOutcome::Kind::Fitted,
          failed_distribution(
              key, {.store = parts_.store, .robots = parts_.robots, .clock = parts_.clock},
              "the fit ended: " + reason)};
}

bool DistributionMaker::is_outdated(const Distribution& distribution) const {
  return is_retired(distribution, parts_.store.experience(distribution.task));
}

Distribution DistributionMaker::keep(fitting::FitOutcome outcome,
                                     const store::FitRight& right) const {
  Distribution distribution = std::move(outcome.distribution).value();
  try {
    distribution.revision = parts_.distributions.put_distribution(distribution, right);
  } catch (const Failure& failure) {
    if (failure.code() == ErrorCode::NotFound || failure.code() == ErrorCode::Unavailable)
      throw;  // its robot or task is gone since, or another server fits it
    distribution.revision = 0;
    distribution.reason += (distribution.reason.empty() ? "not stored: " : "; not stored: ") +
                           std::string(failure.what());
    distribution.reason = cut_text(distribution.reason, kMaxMessageBytes);
  }
  if (distribution.revision > 0 && distribution.selection.since_ms > 0)
    evict_old_dated(distribution);
  if (outcome.warm_state)
    remember(distribution, std::move(outcome.warm_state));
  return distribution;
}

void DistributionMaker::evict_old_dated(const Distribution& kept) const {
  const std::int64_t oldest_ms =
      parts_.clock.unix_ms() - std::chrono::milliseconds(kDatedAge).count();
  std::vector<Digest> old;
  try {
    std::string cursor;
    do {
      const store::Page<DistributionSummary> page =
          parts_.distributions.list_distributions(kept.robot, kept.task, cursor, kMaxPageRows);
      for (const DistributionSummary& row : page.rows)
        if (row.id != kept.id && row.fitted_ms < oldest_ms)
          if (const auto other = parts_.distributions.find_distribution(row.id);
              other && other->selection.since_ms > 0)
            old.push_back(row.id);
      cursor = page.next_cursor;
    } while (!cursor.empty());
    for (const Digest& id : old) {
      parts_.distributions.evict_distribution(id);
      memory_.erase(id);
    }
  } catch (const Failure&) {  // the next one finds them again
  }
}

void DistributionMaker::remember(const Distribution& distribution,
                                 std::shared_ptr<fitting::WarmState> warm_state) const {
  warm_state->revision = distribution.revision;
  if (warm_state->revision == 0)
    warm_state->mixture.reset();  // no revision could name it as its start
  if (distribution.fit && distribution.fit->from_revision == 0)
    warm_state->full.revision = distribution.revision;
  memory_.put(distribution.id, std::move(warm_state));
}

}  // namespace kinship::catalog
