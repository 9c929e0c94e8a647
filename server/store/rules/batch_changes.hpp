#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "proto/types/conversations.hpp"
#include "server/store/rules/batch_state.hpp"
#include "server/store/store.hpp"
#include "server/store/values/path_content.hpp"

/// The changes of a store by a batch of reports. Pointers are to the attempts of the batch.
namespace kinship::store {

/// The codes are part of the schema.
enum class AttemptStatus : std::uint8_t { Stored = 1, DuplicateContent = 2, Unsolved = 3 };

/// A row of `path` to be written.
struct NewPath {
  const PreparedAttempt* from = nullptr;
  ExperienceKey key;
  std::int64_t id = 0;
  std::int64_t received_ms = 0;
  bool is_dropped = false;  ///< stored by one attempt, dropped by it or a later one of the batch
  bool is_retired = false;
};

/// The content of a path's row, which its checksum covers.
/// \param T_task_base  as stored; empty: missing.
PathContent content_of(const NewPath& path, Bytes T_task_base);

/// A row of `attempt` to be written.
struct NewAttempt {
  const PreparedAttempt* from = nullptr;
  ExperienceKey key;
  AttemptStatus status = AttemptStatus::Unsolved;
  std::optional<std::int64_t> path_id = {};
};

/// A report sent again, whose path could not be read any more.
struct RestoredReport {
  Uuid report_uuid;
  AttemptStatus status = AttemptStatus::Stored;
  std::optional<std::int64_t> path_id = {};
};

/// A path found damaged, by this batch or before.
struct DamagedPath {
  std::int64_t id = 0;
  std::optional<std::int64_t> replaced_by = {};  ///< none: its content is beyond the cap
};

/// The change of a row of `experience` by a batch.
struct PairChange {
  bool is_changed = false;  ///< its paths: the generation rises by one
  std::int64_t paths = 0;
  std::int64_t attempts = 0;
  std::int64_t dropped = 0;
  ModeTotals guided = {}, control = {};
};

/// All writes of a batch.
struct BatchChanges {
  std::vector<Receipt> receipts;                  ///< of the attempts, in order
  std::map<Digest, const PreparedScene*> scenes;  ///< by content: missing, or damaged
  std::vector<DamagedPath> damaged;
  std::vector<NewPath> paths;
  std::vector<KeptPath> dropped;
  std::vector<NewAttempt> attempts;
  std::vector<RestoredReport> restored;
  std::set<Uuid> resent;
  std::map<ExperienceKey, PairChange> pairs;

  bool is_empty() const { return attempts.empty() && resent.empty(); }
};

}  // namespace kinship::store
