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
#include "server/runtime/clock.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/runtime/worker_pool.hpp"
#include "server/store/store.hpp"

namespace kinship::catalog {

/// How much of what is bounded there is in a catalog.
struct CatalogUse {
  std::size_t waiters = 0;           ///< fetches that wait
  std::size_t holds = 0;             ///< on leases
  std::size_t in_memory = 0;         ///< distributions
  std::size_t memory_bytes = 0;      ///< of distributions in memory, about
  std::uint64_t dropped = 0;         ///< distributions from memory for want of room, so far
  std::size_t fit_memory_bytes = 0;  ///< that fits left behind for the next ones, about
};

/// Answers fetches: from memory, from the store, or by a fit, of which there is at most one per
/// distribution at a time. A distribution that fell behind its task's experience is served as it
/// is and fitted again behind (freshness.hpp): when it is fetched, or, while somebody holds a lease
/// on it, by itself. One whose paths were retired is not served. May be shared between threads; no
/// lock is held across the store, a fit, an answer or a call of an option.
class Catalog {
 public:
  using TimePoint = CatalogState::TimePoint;
  using Fit = DistributionMaker::Fit;

  /// What the catalog works with; all of it outlives the catalog's last job.
  struct Parts {
    store::Store& store;
    runtime::RobotRegistry& robots;
    runtime::WorkerPool& short_task_pool;  ///< asks the store
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
    /// Called on a worker after each fit that made nothing, but may later: Busy, or Refused if it
    /// would need more memory than there may be.
    std::function<void(const Digest& id, FetchStatus status, const std::string& message)>
        on_trouble = [](const Digest&, FetchStatus, const std::string&) {};
    /// A client was told that it has as many leases, waiting fetches or fits as one may have.
    /// Called from any thread, under the lock: must not call the catalog.
    std::function<void(const std::string& client, ClientBound bound, const std::string& message)>
        on_over_quota = [](const std::string&, ClientBound, const std::string&) {};
    /// Called on a worker after each fit of a distribution under a lease that was stored.
    std::function<void(const Announcement&)> announce = [](const Announcement&) {};
    /// Nobody holds a lease on a distribution any more. Called from any thread.
    std::function<void(const Digest& id)> on_unfollowed = [](const Digest&) {};
    /// next_deadline() is earlier than it was. Called from any thread.
    std::function<void()> wake = [] {};
  };

  Catalog(const Parts& parts, Options options);

  /// `done` is called once, on this thread, a worker, or in expire() or stop(); it must not block.
  /// \param waiter  the name of the request (client_of). Sent again, its earlier `done` is
  /// forgotten.
  void fetch(const FetchRequest& request, const std::string& waiter, FetchDone done);

  /// When expire() has something to do next; empty: not before the next fetch or report.
  std::optional<TimePoint> next_deadline() const;

  /// Tells those Pending whose deadline has passed; their fit goes on. Looks up what is due: after
  /// there was no room for a look-up, and where followed distributions may have fallen behind.
  void expire(TimePoint now);

  /// There are new paths of a task.
  void new_experience(std::string_view task);

  /// Paths of a task were retired, durably. What was made of them is not served after this call
  /// unless it was compared with the store and found to be something else; what is followed is
  /// fitted again.
  void forget(std::string_view task);

  /// A distribution was evicted from the store. It is not served after this call, unless a fit
  /// under way is stored later; what such a fit made earlier answers those who wait for it only.
  void evict(const Digest& id);

  /// A robot was removed from the store. Nothing that was made for it is served after this call,
  /// also what the store had no room for; whoever follows it is told when it is looked up.
  void forget_robot(const Digest& robot);

  /// Answers everybody Busy, now and from now on; fits under way end before their next path.
  void stop();

  std::uint64_t fetches() const noexcept { return fetches_; }  ///< since construction
  std::uint64_t fetches_from_memory() const noexcept { return fetches_from_memory_; }
  /// Those that waited, or that there was no room for; never fewer than before.
  std::uint64_t fetches_not_from_memory() const noexcept { return fetches_not_from_memory_; }
  std::uint64_t fits() const noexcept { return fits_; }
  std::size_t followed() const;  ///< distributions under a lease
  CatalogUse use() const;
  /// What each client has of it, of those that have something.
  std::map<std::string, ClientHolds> holds_of_clients() const;
  /// Why the last fit of a distribution made nothing, in words; empty: it did.
  std::string trouble_of(const Digest& id) const;

 private:
  using Afterwards = CatalogState::Afterwards;
  enum class MadeBy { This, Another };  // server

  /// Changes the state under the lock, then does what follows from that.
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
  std::stop_source stop_source_;
  std::atomic<std::uint64_t> fetches_{0}, fetches_from_memory_{0}, fetches_not_from_memory_{0},
      fits_{0};
  std::atomic<double> typical_fit_s_{1};  // moving mean, for Busy

  mutable std::mutex mutex_;
  CatalogState state_;  // guarded by mutex_
};

}  // namespace kinship::catalog
