#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/catalog/adviser.hpp"
#include "server/catalog/distribution_cache.hpp"
#include "server/catalog/experience_versions.hpp"
#include "server/catalog/fit_troubles.hpp"
#include "server/catalog/leases.hpp"
#include "server/catalog/look_up.hpp"
#include "server/catalog/pending_fits.hpp"
#include "server/runtime/clock.hpp"
#include "server/runtime/worker_pool.hpp"

namespace kinship::catalog {

/// The state of a catalog: replies in memory, leases, pending fits, versions of the experience. It
/// decides which fetches are answered and which distributions are looked up or fitted; Catalog acts
/// on it and guards it. Not shared between threads.
class CatalogState {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  using Priority = runtime::WorkerPool::Priority;

  /// Functions that begin work. None of them waits or calls back.
  struct Work {
    /// False if there is no room for it. `client` asked for it; empty: no particular client.
    std::function<bool(const Digest& id, const std::string& client)> look_up;
    std::function<bool(const Digest& id, Priority priority, const std::string& client)> fit;
    /// The reply to a fetch that cannot be served now.
    std::function<FetchReply(const std::string& message)> busy;
    /// Called when a client is refused for its number of leases, waiters or fits.
    std::function<void(const std::string& client, ClientBound bound, const std::string& message)>
        over_quota = [](const std::string&, ClientBound, const std::string&) {};
  };

  struct Limits {
    DistributionCache::Limits memory;
    std::size_t max_waiters = 4096;
    std::size_t max_leases = 16'384;  ///< holds on leases, of all clients
    // Of one client, 0: no limit. A robot needs one of each per distribution in use.
    std::size_t client_waiters = 256;
    std::size_t client_leases = 256;
    std::size_t client_fits = 64;  ///< looked up or fitted at its request first
  };

  /// Consequences of a change, to be done without the lock.
  struct Afterwards {
    Answers answers;
    std::vector<Digest> unfollowed;
    std::vector<Digest> used;  ///< to be noted in the store
    bool wake = false;         ///< next_deadline() is earlier than before
  };

  /// \param clock  outlives it.
  CatalogState(const runtime::Clock& clock, const Limits& limits, Work work);

  /// The reply in memory, if it answers the request; else the waiter joins a pending fit or is
  /// answered.
  /// \param follow_until  takes a lease, or extends it.
  AdvisedReply fetch(const Digest& id, const fitting::DistributionKey& key, Waiter waiter,
                     std::optional<TimePoint> follow_until, Afterwards& after);
  /// The same reply with newer advice.
  void replace(const Digest& id, const SharedReply& reply, const AdvisedReply& advised) {
    memory_.replace(id, reply, advised);
  }

  /// When a waiter's deadline passes, or a look-up is due.
  std::optional<TimePoint> next_deadline() const;
  void expire(TimePoint now, Afterwards& after);
  void add_experience(std::string_view task, Afterwards& after);
  void retire_experience(std::string_view task, Afterwards& after);
  void evict(const Digest& id, Afterwards& after);
  /// Evicts all distributions known or under way for a robot. \return their ids, in no order; some
  /// twice.
  std::vector<Digest> forget_robot(const Digest& robot, Afterwards& after);
  void stop(Afterwards& after);

  // For the jobs. Each does nothing if the pending fit is gone: the server stops.

  /// The input of a look-up.
  struct LookUpInput {
    fitting::DistributionKey key;
    SharedReply in_memory;
    ExperienceVersion version;
  };
  std::optional<LookUpInput> begin_look_up(const Digest& id);
  /// Takes the result of a look-up, at that version.
  void resolve(const Digest& id, const LookUp& found, const AdvisedReply& known,
               const ExperienceVersion& version, Afterwards& after);
  /// Begins a fit. Empty if another job has begun it.
  std::optional<fitting::DistributionKey> begin_fit(const Digest& id);
  ExperienceVersion version_of(std::string_view task) const { return versions_.of(task); }
  /// A fit is being stored: evictions and retirements from now on concern it.
  void set_stored(const Digest& id, std::string_view task, ExperienceVersion& version);
  /// A fit is complete. \return whether a client follows it, so that it is to be announced.
  bool complete(const Digest& id, std::string_view task, const AdvisedReply& reply,
                const ExperienceVersion& version, Afterwards& after);
  /// \param version  at which nothing was found to fit; empty if not known.
  void end(const Digest& id, const FetchReply& reply,
           const std::optional<ExperienceVersion>& version, Afterwards& after);

  /// A fit made nothing, for a reason that may pass: its waiters are answered, and it is tried
  /// again after a while. The earlier distribution is still served.
  void fail(const Digest& id, FetchStatus status, const std::string& message, Afterwards& after);
  /// The reason why the last fit made nothing; empty: it made one.
  std::string trouble_of(const Digest& id) const;

  const DistributionCache& memory() const { return memory_; }
  std::size_t waiters() const { return pending_.waiters(); }
  std::size_t holds() const { return leases_.holds(); }
  /// The use of each client that has any.
  std::map<std::string, ClientHolds> holds_of_clients() const;
  std::size_t followed() const { return leases_.count(clock_.now()); }

 private:
  AdvisedReply find(const Digest& id, const fitting::DistributionKey& key, std::uint64_t generation,
                    Afterwards& after);
  SharedReply join(const Digest& id, const fitting::DistributionKey& key, Waiter waiter);
  bool follow(const Digest& id, const fitting::DistributionKey& key, TimePoint until,
              const std::string& client);
  SharedReply over_quota(const std::string& client, ClientBound bound, const std::string& what,
                         std::size_t limit) const;
  bool refresh(const Digest& id, const fitting::DistributionKey& key);
  bool request_look_up(const Digest& id, PendingFit& pending);
  void look_up_soon(const Digest& id, PendingFit& pending, Afterwards& after);
  bool request_fit(const Digest& id, PendingFit& pending, Priority priority);
  void resolve_pending(const Digest& id, PendingFit& pending, const LookUp& found,
                       const AdvisedReply& known, const ExperienceVersion& version,
                       Afterwards& after);
  void remember(const Digest& id, const AdvisedReply& reply, const ExperienceVersion& version,
                bool behind);
  void idle(const Digest& id, PendingFit& pending, const ExperienceVersion& version,
            Afterwards& after);
  FetchReply reply_in(const FitTrouble& trouble) const;
  void schedule(const Digest& id, Afterwards& after);
  void look_up_again(std::string_view task, Afterwards& after);

  const runtime::Clock& clock_;
  const Limits limits_;
  const Work work_;
  PendingFits pending_;
  Leases leases_;
  DistributionCache memory_;
  ExperienceVersions versions_;
  FitTroubles troubles_;
  bool stopping_ = false;
};

}  // namespace kinship::catalog
