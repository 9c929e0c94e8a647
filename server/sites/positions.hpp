#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "proto/types/conversations.hpp"
#include "proto/types/uuid.hpp"
#include "server/sites/carry.hpp"
#include "server/store/replication_store.hpp"

namespace kinship::sites {

/// Positions of the exchange between a site and the memory above it. Kept among the notes of the
/// site's store, so that they move with a copied or restored store. A lost or old position costs
/// repeated work, no data. Used by one thread.
class Positions {
 public:
  /// A task whose experience comes down.
  struct Task {
    std::string cursor;        ///< of the memory's arrivals
    std::int64_t used_ms = 0;  ///< time of its last use here
  };
  struct Refused {
    std::string why;
    bool is_put_off = false;
  };

  /// \throws Failure(Storage)
  explicit Positions(store::ReplicationStore& site);

  /// Begins again from the start if the epochs differ from those of the positions. Durable.
  /// \return whether it did.
  bool begin(const Uuid& site_epoch, const Uuid& memory_epoch);

  std::string up, up_retired, down_retired;  ///< cursors
  std::uint64_t passed = 0;                  ///< reports of this site before `up`
  ConsistencyToken token;                    ///< the newest from the memory
  std::map<std::string, Task> tasks;

  /// Records tasks as used here now; precise to the hour, so that not every call is a write.
  void want(const std::set<std::string>& names, std::int64_t now_ms);

  /// Reports that are refused, by UUID. \param is_up  by the memory; else by the site.
  const std::map<Uuid, Refused>& refused(bool is_up) const noexcept { return refused_[is_up]; }
  std::size_t refused_count() const noexcept { return refused_[0].size() + refused_[1].size(); }
  /// \return false, and nothing is kept, if kMaxRefused others of its kind (put off or not) are.
  bool refuse(const RefusedReport& report, bool is_up);
  void accept(const Uuid& report, bool is_up);

  /// Writes the changes in one transaction, durable on return.
  void save();
  bool has_changed() const { return !changes().empty(); }  ///< since it was written

  static constexpr std::size_t kMaxRefused = 10'000;

 private:
  std::map<std::string, std::string> texts() const;  ///< without refusals
  std::map<std::string, std::optional<std::string>> changes() const;

  store::ReplicationStore* site_;
  std::string epochs_;
  std::array<std::map<Uuid, Refused>, 2> refused_;              // by is_up
  std::array<std::size_t, 2> kept_ = {};                        // of both, by is_put_off
  std::map<std::string, std::optional<std::string>> refusals_;  // not saved yet
  std::map<std::string, std::string> saved_;                    // without refusals
};

}  // namespace kinship::sites
