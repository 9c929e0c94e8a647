#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "server/catalog/experience_versions.hpp"
#include "server/catalog/pending_fit.hpp"
#include "server/fitting/distribution_key.hpp"

namespace kinship::catalog {

/// The result of the last comparison of a distribution with the experience of its task.
struct Comparison {
  ExperienceVersion version;
  bool behind = false;
  std::optional<std::int64_t> fitted_ms;  ///< Unix time, UTC; missing: there was no distribution
};

Comparison comparison_of(const Distribution& distribution, const ExperienceVersion& version,
                         bool behind);

/// Leases on distributions: clients that follow a distribution hold a lease on it, and while one of
/// them does, the distribution is kept up to date with the experience without being fetched. The
/// number of holds is bounded, in all and per client. When all are taken, the client with the most
/// holds loses the one that ends first, so that long leases of one client do not end those of
/// others. Not shared between threads.
class Leases {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  struct Lease {
    fitting::DistributionKey key;
    TimePoint until;                           ///< end of its last hold
    std::map<std::string, TimePoint> holders;  ///< by client: end of its hold; at least one
    std::optional<Comparison> compared;        ///< missing: not yet, or not any more
    std::optional<TimePoint> last_look_up;     ///< last comparison with the store, or try
    std::optional<TimePoint> due;              ///< next look-up; set by set_due()
  };

  /// \param max_holds       of all clients together.
  /// \param max_per_client  of each; 0: no limit.
  explicit Leases(std::size_t max_holds, std::size_t max_per_client = 0)
      : max_holds_(max_holds), max_per_client_(max_per_client) {}

  /// Takes a lease for a client, or extends the one it has; never shortens it.
  /// \return false if the client has its maximum.
  bool take(const Digest& id, const fitting::DistributionKey& key, TimePoint until,
            const std::string& client = {});
  void end(Digest id);  // by value: callers name it out of what is erased here
  void end_all();

  /// Forgets the holds that have ended.
  void expire(TimePoint now);
  /// The distributions whose leases ended in any way since the last call, and were not taken again.
  std::vector<Digest> take_ended();

  /// The lease, also one that has ended and was not forgotten yet; null if there is none. Do not
  /// change its key, `until`, `holders` and `due`.
  Lease* find(const Digest& id);
  bool holds(const Digest& id, TimePoint now) const;
  std::size_t count(TimePoint now) const;                ///< leases that have not ended
  std::size_t holds() const noexcept { return holds_; }  ///< of all clients, not yet forgotten
  void add_to(std::map<std::string, ClientHolds>& holds) const;  ///< adds the holds of each client
  std::vector<Digest> of_task(std::string_view task) const;
  std::vector<Digest> of_robot(const Digest& robot) const;

  /// \return whether next_due() is earlier than before.
  bool set_due(const Digest& id, std::optional<TimePoint> due);
  std::optional<TimePoint> next_due() const;
  std::vector<Digest> due(TimePoint now) const;  ///< the earliest first

 private:
  using ByTime = std::set<std::pair<TimePoint, Digest>>;
  /// Number of a client's holds, how soon the first of them ends, and its name; the client with the
  /// greatest load makes room for others.
  using Load = std::tuple<std::size_t, TimePoint::duration, std::string>;
  struct Client {
    ByTime by_end;  // at least one
    Load load;
  };

  void hold(const Digest& id, TimePoint until, const std::string& client);
  void drop(const Digest& id, const std::string& client);
  void set_until(const Digest& id, Lease& lease);
  void make_room(const std::string& client);
  void forget(const Digest& id);
  void weigh(const std::string& client);
  std::size_t count_of(const std::string& client) const;

  std::size_t max_holds_, max_per_client_;
  std::size_t holds_ = 0;
  std::map<Digest, Lease> leases_;
  std::map<std::string, Client> clients_;
  std::set<Load> loads_;
  ByTime by_end_, by_due_;
  std::set<std::tuple<TimePoint, Digest, std::string>> ends_;  // of holds
  std::map<std::string, std::set<Digest>, std::less<>> by_task_;
  std::set<Digest> ended_;
};

}  // namespace kinship::catalog
