#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "proto/types/conversations.hpp"
#include "proto/types/publications.hpp"
#include "server/catalog/adviser.hpp"
#include "server/catalog/catalog_state.hpp"
#include "server/catalog/distribution_maker.hpp"
#include "server/catalog/nearest_task.hpp"
#include "server/runtime/clock.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/runtime/worker_pool.hpp"
#include "server/store/distribution_store.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::catalog {

/// Current use of a catalog's bounded resources.
struct CatalogUse {
  std::size_t waiters = 0;           ///< waiting fetches
  std::size_t holds = 0;             ///< on leases
  std::size_t in_memory = 0;         ///< distributions
  std::size_t memory_bytes = 0;      ///< of distributions in memory, about
  std::uint64_t dropped = 0;         ///< distributions from memory for want of room, so far
  std::size_t fit_memory_bytes = 0;  ///< of states kept by fits for the next ones, about
};

/// Answers fetches: from memory, from the store, or by a fit, of which there is at most one per
/// distribution at a time. A distribution behind its task's experience is still served and fitted
/// again in the background (freshness.hpp): when it is fetched, or, while a client holds a lease on
/// it, by itself. A distribution whose paths were retired is not served. May be shared between
/// threads; no lock is held across the store, a fit, an answer or a call of an option.
class Catalog {
 public:
  using TimePoint = CatalogState::TimePoint;
  using Fit = DistributionMaker::Fit;

  /// References; they outlive the catalog's last job.
  struct Parts {
    const store::ExperienceStore& store;
    store::DistributionStore& distributions;
    runtime::RobotRegistry& robots;
    runtime::WorkerPool& short_task_pool;  ///< looks up in the store
    runtime::WorkerPool& fitters;          ///< transfers and fits
    const runtime::Clock& clock;
    fitting::MemoryCeiling* memory = nullptr;  ///< of all fits together; null: no limit
  };

  struct Options {
    CatalogState::Limits limits;
    Fit fit;  ///< empty: fit_distribution
    AdviceSource advice;
    /// Called on a worker after each fit, ready or failed.
    std::function<void(const Distribution&)> on_fit = [](const Distribution&) {};
    /// Called on a worker after each fit that made nothing but may succeed later: Busy, or Refused
    /// if it would exceed the memory limit.
    std::function<void(const Digest& id, FetchStatus status, const std::string& message)>
        on_trouble = [](const Digest&, FetchStatus, const std::string&) {};
    /// Called when a client is refused for its number of leases, waiting fetches or fits, from any
    /// thread, under the lock: must not call the catalog.
    std::function<void(const std::string& client, ClientBound bound, const std::string& message)>
        on_over_quota = [](const std::string&, ClientBound, const std::string&) {};
    /// Called on a worker after each fit of a distribution under a lease that was stored.
    std::function<void(const Announcement&)> announce = [](const Announcement&) {};
    /// Called when the last lease on a distribution has ended. From any thread.
    std::function<void(const Digest& id)> on_unfollowed = [](const Digest&) {};
    /// Called when next_deadline() is earlier than before. From any thread.
    std::function<void()> wake = [] {};
  };

  Catalog(const Parts& parts, Options options);

  /// `done` is called once, on this thread, a worker, or in expire() or stop(); it must not block.
  /// \param waiter  the name of the request (client_of). If it is sent again, its earlier `done` is
  ///                dropped.
  void fetch(const FetchRequest& request, const std::string& waiter, FetchDone done);

  /// When expire() is to be called next; empty: not before the next fetch or report.
  std::optional<TimePoint> next_deadline() const;

  /// Answers Pending to fetches whose deadline has passed; their fit goes on. Makes the due
  /// look-ups: those that had no room before, and those of followed distributions that may be
  /// behind.
  void expire(TimePoint now);

  /// To be called when a task has new paths.
  void new_experience(std::string_view task);

  /// To be called when paths of a task were retired, durably. A distribution of the task is not
  /// served after this call until a look-up has shown that it was not made of them; followed ones
  /// are fitted again.
  void forget(std::string_view task);

  /// To be called when a distribution was evicted from the store. It is not served after this call,
  /// unless a fit under way is stored later; the result of a fit stored before answers only its
  /// waiters.
  void evict(const Digest& id);

  /// To be called when a robot was removed from the store. No distribution for it is served after
  /// this call, even one that could not be stored; the leases on it end at their next look-up.
  void forget_robot(const Digest& robot);

  /// Answers all fetches Busy, waiting and later ones; fits under way end before their next path.
  void stop();

  std::uint64_t fetches() const noexcept { return fetches_; }  ///< since construction
  std::uint64_t fetches_from_memory() const noexcept { return fetches_from_memory_; }
  /// Fetches that waited or were refused for want of room; never decreases.
  std::uint64_t fetches_not_from_memory() const noexcept { return fetches_not_from_memory_; }
  std::uint64_t fits() const noexcept { return fits_; }
  std::size_t followed() const;  ///< distributions under a lease
  CatalogUse use() const;
  /// The use of each client that has any.
  std::map<std::string, ClientHolds> holds_of_clients() const;
  /// The reason why the last fit of a distribution made nothing; empty: it made one.
  std::string trouble_of(const Digest& id) const;

 private:
  using Afterwards = CatalogState::Afterwards;
  enum class MadeBy { This, Another };  // server

  /// Changes the state under the lock, then finishes the consequences without it.
  template <typename Change>
  void change(Change change);
  void finish(const Afterwards& after) const;

  // On workers, without the lock.
  void look_up(const Digest& id);
  void run_fit(const Digest& id);
  fitting::FitOutcome fit(const Digest& id, const fitting::DistributionKey& key,
                          ExperienceVersion& version);
  std::optional<Distribution> made_elsewhere(const Digest& id, const fitting::DistributionKey& key);
  void complete(const Digest& id, const fitting::DistributionKey& key, Distribution distribution,
                const ExperienceVersion& version, MadeBy made_by);
  void fail(const Digest& id, FetchStatus status, const std::string& message);
  void end(const Digest& id, const FetchReply& reply,
           const std::optional<ExperienceVersion>& version);

  CatalogState::Work work();
  FetchReply busy(const std::string& message) const;

  const Parts parts_;
  const Options options_;
  const Adviser adviser_;
  const DistributionMaker maker_;
  NearestTasks nearest_tasks_;
  std::stop_source stop_source_;
  std::atomic<std::uint64_t> fetches_{0}, fetches_from_memory_{0}, fetches_not_from_memory_{0},
      fits_{0};
  std::atomic<double> typical_fit_s_{1};  // moving mean, for Busy

  mutable std::mutex mutex_;
  CatalogState state_;  // guarded by mutex_
};

}  // namespace kinship::catalog
