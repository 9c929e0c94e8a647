#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/recall_library.hpp"
#include "proto/types/rehearsal.hpp"

namespace kinship::store {

/// A rehearsal of one robot and task with its library of paths to recall, and what it was made of.
struct StoredRehearsal {
  Digest id;  ///< of the distribution
  Digest robot;
  std::string task;
  std::int64_t made_ms = 0;   ///< Unix time, UTC
  Digest kind = {};           ///< equal for questions that differ in the placement alone
  std::uint64_t paths = 0;    ///< of the experience
  std::uint64_t retired = 0;  ///< another number once a path of the task was retired
  std::optional<Eigen::Isometry3d> T_task_base = {};
  Rehearsal rehearsal = {};
  std::optional<RecallLibrary> library = {};  ///< its waypoints are stored as float
};

/// What a store keeps of rehearsals; beyond it the oldest go.
struct RehearsalLimits {
  std::size_t count = 256;
  std::uint64_t bytes = std::uint64_t{64} << 20U;
};

/// Keeps rehearsals, which can be made anew where one is missing or damaged; see Store.
class RehearsalStore {
 public:
  /// Stores a rehearsal, durable on return; then deletes the earlier one with its id, and the
  /// oldest ones beyond the limits, but never the newest.
  /// \throws Failure(InvalidInput) if a part exceeds its limit, so that it could not be read back.
  virtual void put_rehearsal(const StoredRehearsal& rehearsal,
                             const RehearsalLimits& limits = {}) = 0;
  /// The newest first, without damaged ones and those of another kRehearsalVersion.
  virtual std::vector<StoredRehearsal> read_rehearsals(std::size_t limit) const = 0;

 protected:
  ~RehearsalStore() = default;
};

}  // namespace kinship::store
