#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "proto/types/conversations.hpp"
#include "server/store/postgres/rows/batch_knowledge.hpp"
#include "server/store/store.hpp"

namespace kinship::store::postgres {

/// The codes are part of the schema.
enum class AttemptStatus : std::uint8_t { Stored = 1, DuplicateContent = 2, Unsolved = 3 };

/// A row of `path` to be written.
struct PlannedPath {
  const PreparedAttempt* from = nullptr;
  ExperienceKey key;
  std::int64_t id = 0;
  std::int64_t received_ms = 0;
  bool is_dropped = false;  ///< kept by one attempt, and gone with a later one of the same batch
  bool is_retired = false;
};

/// A row of `attempt` to be written.
struct PlannedAttempt {
  const PreparedAttempt* from = nullptr;
  ExperienceKey key;
  AttemptStatus status = AttemptStatus::Unsolved;
  std::optional<std::int64_t> path_id = {};
};

/// An attempt that came again, whose path could not be read any more.
struct MendedAttempt {
  Uuid report_uuid;
  AttemptStatus status = AttemptStatus::Stored;
  std::optional<std::int64_t> path_id = {};
};

/// A path in use that turned out to be damaged.
struct DamagedPath {
  std::int64_t id = 0;
  std::optional<std::int64_t> replaced_by = {};
};

/// What a batch adds to a row of `experience`.
struct PairChange {
  bool is_changed = false;  ///< its paths: the generation rises by one
  std::int64_t paths = 0;
  std::int64_t attempts = 0;
  std::int64_t dropped = 0;
  ModeTotals guided = {}, control = {};
};

/// All that a batch writes.
struct BatchPlan {
  std::vector<Receipt> receipts;  ///< of the attempts, in order
  std::map<Digest, const PreparedScene*> scenes;
  std::vector<DamagedPath> damaged;
  std::vector<PlannedPath> paths;
  std::vector<KeptPath> dropped;
  std::vector<PlannedAttempt> attempts;
  std::vector<MendedAttempt> mended;
  std::set<Uuid> resent;
  std::map<ExperienceKey, PairChange> changes;

  bool writes_nothing() const { return attempts.empty() && resent.empty(); }
};

/// Decides what becomes of each attempt, one after the other, as if each were written before the
/// next is looked at.
/// \param max_paths  of a robot and task: those with the smallest content digests are kept (see
///                   retention in docs/decisions/store.md); 0: no cap.
BatchPlan make_plan(PreparedAttempts attempts, BatchKnowledge known, std::uint64_t max_paths,
                    std::int64_t now_ms);

}  // namespace kinship::store::postgres
