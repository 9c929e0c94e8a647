#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/digest.hpp"
#include "server/store/admin_store.hpp"
#include "server/store/distribution_store.hpp"
#include "server/store/experience_store.hpp"
#include "server/store/rehearsal_store.hpp"
#include "server/store/replication_store.hpp"
#include "server/store/report_store.hpp"
#include "server/store/robot_store.hpp"

namespace kinship::store {

/// A robot and task that changed, and its current summary.
struct ChangedExperience {
  std::string task;
  ExperienceSummary now;
};

/// Changes of a store since an earlier look, by any server.
struct StoreChanges {
  std::string cursor;                         ///< for the next look
  std::vector<ChangedExperience> experience;  ///< new attempts, paths retired or dropped
  std::vector<Digest> robots;   ///< registered, renamed, with better geometry, or removed
  std::vector<Digest> evicted;  ///< distributions, on request; not for want of room
  /// Former names of renamed tasks; their new names are in `experience`.
  std::vector<std::string> former_tasks = {};
};

/// Keeps robots, attempts, paths, distributions and rehearsals. A part of the server takes the
/// interfaces that it needs. Every method of them may be called from any thread. Reads see
/// committed data only. Methods throw Failure(Storage) unless said otherwise.
///
/// Changes by an administrator take an `audit`, which names the administrator and the request. The
/// store adds it to the audit log, with the values before and after, in the transaction of the
/// change; of several transactions the first says Begun and the last Done. A change that is not
/// done leaves no entry. Null: no entry.
class Store : public RobotStore,
              public ReportStore,
              public ExperienceStore,
              public DistributionStore,
              public RehearsalStore,
              public ReplicationStore,
              public AdminStore {
 public:
  virtual ~Store() = default;

  /// To be called when the server stops, from any thread: ends every wait for a database that does
  /// not answer; waiting calls and all later ones throw. Does nothing for a file.
  virtual void stop_waiting() noexcept {}

  /// Changes since the last look, by this server or another of the same store; changes under way
  /// are in the next look. A change may be reported twice.
  /// \param cursor  of the last look; empty: begins now, without changes.
  /// \return nothing if the store has one server, which knows its own changes.
  virtual std::optional<StoreChanges> changes_since(std::string_view cursor) const {
    (void)cursor;
    return std::nullopt;
  }
};

}  // namespace kinship::store
