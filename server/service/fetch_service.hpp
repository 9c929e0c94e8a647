#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "proto/types/conversations.hpp"
#include "server/catalog/advice_cache.hpp"
#include "server/catalog/catalog.hpp"
#include "server/catalog/experience_index.hpp"
#include "server/rehearsal/rehearsal_scheduler.hpp"
#include "server/service/served_guidance.hpp"
#include "server/service/service_parts.hpp"
#include "server/service/upstream.hpp"

namespace kinship::service {

/// Answers fetches with distributions, ways and guides, and keeps these up to date with the
/// experience of the store. May be shared between threads; `done` as in Service.
class FetchService final : public ServedGuidance {
 public:
  using TimePoint = catalog::Catalog::TimePoint;

  /// \param store, distributions, rehearsals, upstream  outlive the service.
  FetchService(const ServiceParts& parts, const store::ExperienceStore& store,
               store::DistributionStore& distributions, store::RehearsalStore& rehearsals,
               Upstream& upstream);
  FetchService(const FetchService&) = delete;
  FetchService& operator=(const FetchService&) = delete;

  /// \param waiter  the caller; see Catalog::fetch.
  void fetch(const FetchRequest& request, const std::string& waiter, catalog::FetchDone done);
  /// Answers and counts a fetch that is refused before it reaches the catalog.
  void refuse(const std::string& why, const std::function<void(const FetchReply&)>& done);
  /// The same for a fetch that cannot be answered now: Busy, and when to ask again.
  void postpone(const std::string& why, const std::function<void(const FetchReply&)>& done);

  /// A task has new paths.
  void new_experience(std::string_view task) override;
  /// An attempt was committed.
  void add(const catalog::AttemptCost& cost) { advice_.add(cost); }
  void forget_task(const std::string& task) override { forget(task, Loss::Paths); }
  void drop_task(const std::string& task) override { forget(task, Loss::Task); }
  void forget_robot(const Digest& robot) override;
  void forget_distribution(const Digest& id) override { catalog_.evict(id); }
  /// Stops serving from memory data that another server changed in the store. One call at a time.
  /// \throws Failure(Storage)
  void take_changes(const store::StoreChanges& changes);

  Advice advise(const Distribution& distribution) override;
  std::shared_ptr<const Rehearsal> find_rehearsal(const Digest& id) const override {
    return rehearsals_.find(id);
  }
  std::string trouble_of(const Digest& id) const override { return catalog_.trouble_of(id); }

  void expire(TimePoint now);
  /// Answers waiting fetches Busy and gives up fits. Fits that run end soon; join() waits for them.
  void stop();
  void join() { fitters_.stop(runtime::WorkerPool::Leftovers::Abandon); }

  const catalog::Catalog& catalog() const noexcept { return catalog_; }
  const catalog::AdviceCache& advice() const noexcept { return advice_; }
  const catalog::ExperienceIndex& experience() const noexcept { return experience_; }
  const rehearsal::RehearsalScheduler& rehearsals() const noexcept { return rehearsals_; }
  fitting::MemoryCeiling& memory() noexcept { return memory_; }  ///< of all fits together
  const fitting::MemoryCeiling& memory() const noexcept { return memory_; }
  std::size_t queued_fits() const { return fitters_.queued(); }

 private:
  using Loss = rehearsal::RehearsalScheduler::Loss;
  void forget(const std::string& task, Loss loss);
  catalog::Catalog::Options catalog_options();
  catalog::FetchDone of_this_epoch(catalog::FetchDone done) const;
  void count_fetch(const FetchReply& reply);
  void log_fit(const Distribution& distribution) const;

  const ServiceParts parts_;
  const store::ExperienceStore& store_;
  Upstream& upstream_;
  catalog::ExperienceIndex experience_;
  catalog::AdviceCache advice_;
  fitting::MemoryCeiling memory_;
  runtime::WorkerPool fitters_;
  catalog::Catalog catalog_;
  /// Of take_changes(): when a path of a task and robot was last seen to be retired. Read before
  /// the rehearsals, which leave out what was retired by then.
  std::map<std::pair<std::string, Digest>, std::uint64_t> retired_generations_;
  rehearsal::RehearsalScheduler rehearsals_;  // its thread uses the experience and the memory
};

}  // namespace kinship::service
