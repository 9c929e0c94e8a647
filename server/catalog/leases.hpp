#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "server/catalog/experience_versions.hpp"
#include "server/fitting/distribution_key.hpp"

namespace kinship::catalog {

/// What was found when a distribution was last compared with the experience of its task.
struct Comparison {
  ExperienceVersion version;
  bool behind = false;
  std::optional<std::int64_t> fitted_ms;  ///< Unix time, UTC; missing: there was no distribution
};

Comparison comparison_of(const Distribution& distribution, const ExperienceVersion& version,
                         bool behind);

/// Interest in distributions: whoever follows one holds a lease on it, and as long as it is held
/// the distribution is kept up with the experience without being fetched. A bounded number; the
/// one that ends first goes first. Not shared between threads.
class Leases {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  struct Lease {
    fitting::DistributionKey key;
    TimePoint until;
    std::optional<Comparison> compared;     ///< missing: not yet, or not any more
    std::optional<TimePoint> last_look_up;  ///< when it was compared with the store, or tried to be
    std::optional<TimePoint> due;           ///< when to look again; set by set_due()
  };

  explicit Leases(std::size_t max_leases) : max_leases_(max_leases) {}

  /// Takes a lease, or extends the one that is there; never shortens it.
  void take(const Digest& id, const fitting::DistributionKey& key, TimePoint until);
  void end(Digest id);  // by value: callers name it out of what is erased here
  void end_all();

  /// Forgets the leases that have ended.
  void expire(TimePoint now);
  /// Whose leases ended in any way since the last call, and were not taken again.
  std::vector<Digest> take_ended();

  /// The lease, also one that has ended and was not forgotten yet; null if there is none. Its key,
  /// `until` and `due` are not to be changed through it.
  Lease* find(const Digest& id);
  bool holds(const Digest& id, TimePoint now) const;
  std::size_t count(TimePoint now) const;  ///< of those that have not ended
  std::vector<Digest> of_task(std::string_view task) const;

  /// \return whether next_due() is earlier than before.
  bool set_due(const Digest& id, std::optional<TimePoint> due);
  std::optional<TimePoint> next_due() const;
  std::vector<Digest> due(TimePoint now) const;  ///< the earliest first

 private:
  using ByTime = std::set<std::pair<TimePoint, Digest>>;

  std::size_t max_leases_;
  std::map<Digest, Lease> leases_;
  ByTime by_end_, by_due_;
  std::map<std::string, std::set<Digest>, std::less<>> by_task_;
  std::set<Digest> ended_;
};

}  // namespace kinship::catalog
