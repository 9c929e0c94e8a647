#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/conversations.hpp"
#include "proto/types/publications.hpp"
#include "server/catalog/adviser.hpp"
#include "server/catalog/distribution_cache.hpp"
#include "server/catalog/distribution_maker.hpp"
#include "server/catalog/flights.hpp"
#include "server/catalog/leases.hpp"
#include "server/catalog/look_up.hpp"
#include "server/catalog/task_marks.hpp"
#include "server/runtime/clock.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/runtime/worker_pool.hpp"
#include "server/store/store.hpp"

namespace kinship::catalog {

/// Answers fetches: from memory, from the store, or by a fit, of which there is at most one per
/// distribution at a time. A distribution that fell behind its task's experience is served as it
/// is and fitted again behind (freshness.hpp): when it is fetched, or, while somebody holds a lease
/// on it, by itself. One whose paths were retired is not served. May be shared between threads; no
/// lock is held across the store, a fit, an answer or a call of an option.
class Catalog {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  using Fit = DistributionMaker::Fit;

  /// What the catalog works with; all of it outlives the catalog's last job.
  struct Parts {
    store::Store& store;
    runtime::RobotRegistry& robots;
    runtime::WorkerPool& desk;     ///< asks the store
    runtime::WorkerPool& fitters;  ///< transfers and fits
    const runtime::Clock& clock;
  };

  struct Options {
    DistributionCache::Limits memory;
    std::size_t max_waiters = 4096;
    std::size_t max_leases = 4096;
    Fit fit;  ///< empty: fit_distribution
    AdviceSource advice;
    /// Called on a worker after each fit, ready or failed.
    std::function<void(const Distribution&)> on_fit = [](const Distribution&) {};
    /// Called on a worker after each fit of a distribution under a lease that was stored.
    std::function<void(const Announcement&)> announce = [](const Announcement&) {};
    /// Nobody holds a lease on a distribution any more. Called from any thread.
    std::function<void(const Digest& id)> on_unfollowed = [](const Digest&) {};
    /// next_deadline() is earlier than it was. Called from any thread.
    std::function<void()> wake = [] {};
  };

  Catalog(const Parts& parts, Options options);

  /// `done` is called once, on this thread, a worker, or in expire() or stop(); it must not block.
  /// \param waiter  who asks. If the same waiter asks again its earlier `done` is forgotten.
  void fetch(const FetchRequest& request, const std::string& waiter, FetchDone done);

  /// When expire() has something to do next; empty: not before the next fetch or report.
  std::optional<TimePoint> next_deadline() const;

  /// Tells those Pending whose deadline has passed; their fit goes on. Looks where a look is due:
  /// after the desk had no room for it, and where followed distributions may have fallen behind.
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

  /// Answers everybody Busy, now and from now on; fits under way end before their next path.
  void stop();

  std::uint64_t fetches() const noexcept { return fetches_; }  ///< since construction
  std::uint64_t fetches_from_memory() const noexcept { return fetches_from_memory_; }
  std::uint64_t fits() const noexcept { return fits_; }
  std::size_t followed() const;  ///< distributions under a lease

 private:
  /// What is to be done once no lock is held.
  struct Afterwards {
    Answers answers;
    std::vector<Digest> unfollowed;
    bool wake = false;
  };
  void finish(const Afterwards& after) const;

  // On workers, without the lock.
  void look(const Digest& id);
  void run_fit(const Digest& id);
  void settle(const Digest& id, const LookUp& found, const AdvisedReply& known, const Marks& marks);
  fitting::FitOutcome fit(const Digest& id, const fitting::DistributionKey& key, Marks& marks);
  void land(const Digest& id, const fitting::DistributionKey& key, Distribution distribution,
            const Marks& marks);
  void end_flight(const Digest& id, const FetchReply& reply, const std::optional<Marks>& marks);

  // With the lock held.
  AdvisedReply find(const Digest& id, const fitting::DistributionKey& key,
                    std::uint64_t generation);
  SharedReply join(const Digest& id, const fitting::DistributionKey& key, Waiter waiter);
  bool refresh(const Digest& id, const fitting::DistributionKey& key);
  bool begin_look(const Digest& id, Flight& flight);
  void look_soon(const Digest& id, Flight& flight, Afterwards& after);
  bool begin_fit(const Digest& id, Flight& flight, runtime::WorkerPool::Priority priority);
  void settle_flight(const Digest& id, Flight& flight, const LookUp& found,
                     const AdvisedReply& known, const Marks& marks, Afterwards& after);
  void end(const Digest& id, Flight& flight, const FetchReply& reply,
           const std::optional<Marks>& marks, Afterwards& after);
  void follow(const Digest& id, const fitting::DistributionKey& key, TimePoint until);
  void remember(const Digest& id, const AdvisedReply& reply, const Marks& marks, bool behind);
  void rest(const Digest& id, Flight& flight, const Marks& marks, Afterwards& after);
  void tend(const Digest& id, Afterwards& after);
  void look_again(std::string_view task, Afterwards& after);
  FetchReply busy(const std::string& message) const;

  const Parts parts_;
  const Options options_;
  const Adviser adviser_;
  const DistributionMaker maker_;
  std::stop_source stop_source_;
  std::atomic<std::uint64_t> fetches_{0}, fetches_from_memory_{0}, fits_{0};
  std::atomic<double> typical_fit_s_{1};  // moving mean, for Busy

  mutable std::mutex mutex_;  // guards what follows
  Flights flights_;
  Leases leases_;
  DistributionCache memory_;
  TaskMarks marks_;
  bool stopping_ = false;
};

}  // namespace kinship::catalog
