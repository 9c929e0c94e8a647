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
#include <unordered_map>
#include <vector>

#include "proto/types/conversations.hpp"
#include "server/service/clock.hpp"
#include "server/service/distribution_cache.hpp"
#include "server/service/fit_distribution.hpp"
#include "server/service/flight.hpp"
#include "server/service/robot_registry.hpp"
#include "server/service/worker_pool.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// Answers fetches: from memory, from the store, or by a fit, of which there is at most one per
/// distribution at a time. A distribution that fell behind its task's experience is served as it
/// is and fitted again behind (freshness.hpp). May be shared between threads; no lock is held
/// across the store, a fit or an answer.
class Catalog {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  using Fit = std::function<FitOutcome(const DistributionKey&, const std::stop_token&)>;

  /// What the catalog works with; all of it outlives the catalog's last job.
  struct Parts {
    store::Store& store;
    RobotRegistry& robots;
    WorkerPool& desk;     ///< asks the store
    WorkerPool& fitters;  ///< transfers and fits
    const Clock& clock;
  };

  struct Options {
    DistributionCache::Limits memory;
    std::size_t max_waiters = 4096;
    Fit fit;  ///< empty: fit_distribution
    /// Called on a worker after each fit, ready or failed.
    std::function<void(const Distribution&)> on_fit = [](const Distribution&) {};
  };

  Catalog(const Parts& parts, Options options);

  /// `done` is called once, on this thread, a worker, or in expire() or stop(); it must not block.
  /// \param waiter  who asks. If the same waiter asks again its earlier `done` is forgotten.
  void fetch(const FetchRequest& request, const std::string& waiter, FetchDone done);

  /// When expire() has something to do next; empty: not before the next fetch.
  std::optional<TimePoint> next_deadline() const;

  /// Tells those Pending whose deadline has passed; their fit goes on. Looks again where there was
  /// no room on the desk for it.
  void expire(TimePoint now);

  /// There are new paths of a task.
  void new_experience(std::string_view task);

  /// Answers everybody Busy, now and from now on; fits under way end before their next path.
  void stop();

  std::uint64_t fetches() const noexcept { return fetches_; }  ///< since construction
  std::uint64_t fetches_from_memory() const noexcept { return fetches_from_memory_; }
  std::uint64_t fits() const noexcept { return fits_; }

 private:
  using Flights = std::unordered_map<Digest, Flight>;

  // On workers, without the lock.
  void look(const Digest& id);
  void run_fit(const Digest& id);
  /// A fit that threw becomes a failure with its reason, so that it is not tried for ever.
  /// \throws Failure(Storage or Unavailable), which may pass.
  FitOutcome try_fit(const DistributionKey& key) const;
  SharedReply keep(Distribution distribution);
  void settle(const Digest& id, const SharedReply& known,
              const std::vector<store::ExperienceSummary>& experience, std::uint64_t changes);
  void land(const Digest& id, const SharedReply& reply, std::uint64_t changes);
  void end_flight(const Digest& id, const FetchReply& reply);

  // With the lock held.
  SharedReply find(const Digest& id, const FetchRequest& request, bool& due);
  SharedReply join(const Digest& id, const DistributionKey& key, Waiter waiter);
  void refresh(const Digest& id, const DistributionKey& key);
  bool begin_look(const Digest& id, Flight& flight);
  void look_soon(const Digest& id, Flight& flight);
  bool begin_fit(const Digest& id, Flight& flight, WorkerPool::Priority priority);
  void rest(Flights::iterator flight, std::uint64_t changes);
  std::uint64_t changes_of(const std::string& task) const;
  std::size_t waiter_count() const;
  FetchReply busy(const std::string& message) const;
  FetchReply without(const Error& robot_error) const;

  const Parts parts_;
  const Options options_;
  std::stop_source stop_source_;
  std::atomic<std::uint64_t> fetches_{0}, fetches_from_memory_{0}, fits_{0};
  std::atomic<double> typical_fit_s_{1};  // moving mean, for Busy

  mutable std::mutex mutex_;  // guards what follows
  Flights flights_;
  DistributionCache memory_;
  std::map<std::string, std::uint64_t> changes_;  // of each task's experience, since construction
  bool stopping_ = false;
};

}  // namespace kinship::service
