#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
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

/// The sums of a row of `experience`: calls visit(mode, column, change), whose name is both
/// together, with a change of std::int64_t or double. Both engines write, and a move copies, by it.
template <typename Visit>
void for_each_sum(const PairChange& change, Visit visit) {
  using Mode = std::string_view;
  visit(Mode(), "paths", change.paths);
  visit(Mode(), "attempts", change.attempts);
  visit(Mode(), "dropped", change.dropped);
  for (const auto& [mode, totals] :
       {std::pair<Mode, const ModeTotals&>("guided", change.guided),
        std::pair<Mode, const ModeTotals&>("control", change.control)}) {
    visit(mode, "_attempts", static_cast<std::int64_t>(totals.attempts));
    visit(mode, "_solved", static_cast<std::int64_t>(totals.solved));
    visit(mode, "_checks", totals.checks);
    visit(mode, "_checks_squared", totals.checks_squared);
    visit(mode, "_checks_of_solved", totals.checks_of_solved);
    visit(mode, "_measured", static_cast<std::int64_t>(totals.measured));
    visit(mode, "_time_s", totals.time_s);
    visit(mode, "_length", totals.length);
    visit(mode, "_hand_length_m", totals.hand_length_m);
    visit(mode, "_clearance_m", totals.clearance_m);
  }
}

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
