#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "proto/types/conversations.hpp"
#include "proto/types/uuid.hpp"
#include "server/sites/carry.hpp"
#include "server/store/store.hpp"

namespace kinship::sites {

/// How far a site and the memory above it have told each other. Kept among the notes of the site's
/// store, so that it goes with the store wherever that is copied or restored. Whatever of it is
/// lost or too old costs work, nothing else. Used by one thread.
class Positions {
 public:
  /// A task whose experience is brought down.
  struct Task {
    std::string cursor;        ///< of the memory's arrivals
    std::int64_t used_ms = 0;  ///< when it was last asked for here
  };
  struct Refused {
    bool is_up = true;  ///< refused by the memory; else here
    std::string why;
  };

  /// \throws Failure(Storage)
  explicit Positions(store::Store& site);

  /// Begins again from the start if the epochs are not those of the positions. Durable.
  /// \return whether it began.
  bool begin(const Uuid& site_epoch, const Uuid& memory_epoch);

  std::string up, up_retired, down_retired;  ///< cursors
  std::uint64_t passed = 0;                  ///< reports of this site before `up`
  HistoryMark mark;                          ///< the newest that the memory gave
  std::map<std::string, Task> tasks;

  /// These are used here now; precise to the hour, so that not each look is a write.
  void want(const std::set<std::string>& names, std::int64_t now_ms);

  /// What was set aside, by report; of more than kMaxRefused the reasons are not kept.
  const std::map<Uuid, Refused>& refused() const noexcept { return refused_; }
  void refuse(const RefusedReport& report, bool is_up);
  void accept(const Uuid& report);

  /// Writes what changed, in one transaction, durable on return.
  void save();
  bool has_changed() const { return !changes().empty(); }  ///< since it was written

  static constexpr std::size_t kMaxRefused = 10'000;

 private:
  std::map<std::string, std::string> texts() const;  ///< without refusals
  std::map<std::string, std::optional<std::string>> changes() const;

  store::Store* site_;
  std::string epochs_;
  std::map<Uuid, Refused> refused_;
  std::map<std::string, std::optional<std::string>> refusals_;  // not saved yet
  std::map<std::string, std::string> saved_;                    // without refusals
};

}  // namespace kinship::sites
