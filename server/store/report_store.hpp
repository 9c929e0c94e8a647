#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/uuid.hpp"

namespace kinship::store {

/// How far a store has come: it has every report with a receipt up to this point as long as the
/// point lies on its history.
struct StorePoint {
  Uuid epoch;
  ConsistencyToken token;  ///< of the newest attempt that is durable
};

/// What a store keeps of search records; beyond it the oldest go, in the order in which they came.
struct SearchLimits {
  std::uint64_t bytes = std::uint64_t{256} << 20U;  ///< 0: none is kept
  std::uint32_t days = 90;                          ///< 0: no limit
};

/// Commits the reports of robots, and finds the loss of reports that have a receipt; see Store.
class ReportStore {
 public:
  using ReportsDone = std::function<void(const std::vector<Receipt>&)>;

  /// Queues checked attempts; `done` is called on the writer thread after the commit is durable (or
  /// failed, or the queue is full: TryAgain), one receipt per attempt in order. Queued attempts are
  /// committed together. `done` must not throw, block or wait for a write. Never throws Storage.
  ///
  /// Same UUID and body: Duplicate. Same UUID, other body: Refused. A robot that is not registered
  /// (any more): UnknownRobot. A path whose content (waypoints and snapped placement, or none) the
  /// robot and task have already: its attempt is recorded and answered Duplicate.
  ///
  /// At the cap of a robot and task (an option of the engine) the paths with the smallest content
  /// digests are kept. A path that is not kept is answered Recorded, with the reason; a Stored one
  /// may drop another path. Later readings leave a dropped path out; it raises the generation, but
  /// not retired_generation, as a distribution fitted with it is as good as before. Its attempt and
  /// UUID stay, its waypoints do not.
  virtual void commit_reports(std::vector<Attempt> attempts, ReportsDone done) = 0;

  virtual StorePoint point() const = 0;
  /// Whether a client's consistency token is of this epoch and the store has lost reports that it
  /// had then. Tokens that this store never made are not lost. May read a shared store; if that
  /// fails the token counts as not lost.
  virtual bool has_lost(const ConsistencyToken& token) const = 0;
  /// Whether has_lost() may be true. From memory.
  virtual bool may_have_lost(const ConsistencyToken& token) const { return has_lost(token); }
  /// Begins a new epoch if a token is lost, durable on return. \return whether it began.
  virtual bool begin_epoch_if_lost(const ConsistencyToken& token) = 0;

 protected:
  ~ReportStore() = default;
};

}  // namespace kinship::store
