#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/store/rules/batch_changes.hpp"
#include "server/store/rules/batch_state.hpp"

/// The rules of a report, for every engine: when it came before, when its path is kept, what its
/// receipt says. Values in, values out.
///
/// A cap keeps the paths with the smallest content digests of a robot and task. Digests of distinct
/// paths are as good as drawn at random, so these are a random sample without replacement of all
/// that were reported (bottom-k: Cohen and Kaplan, 2007), and the same one in whatever order, and
/// to whichever server, they were reported.
namespace kinship::store {

/// Paths of a robot and task that one report may drop; each is written anew. After the cap was
/// lowered the next reports drop the others.
inline constexpr std::uint64_t kMaxDroppedAtOnce = 64;

/// Whether a report is the one that came before. Its machine may be called otherwise since: by the
/// name in a certificate that it had not then, or has not any more.
bool is_again(const PreparedAttempt& prepared, const EarlierReport& earlier);

/// The receipt of a report that changes nothing: its UUID is another report's, its robot is not
/// registered, or its path has another number of joints. Nothing: it is acceptable.
/// \param state  robots and reports (body and machine) are enough.
std::optional<Receipt> refusal_of(const PreparedAttempt& prepared, const BatchState& state);

/// The attempts without those that are refused.
std::vector<const PreparedAttempt*> acceptable(PreparedAttempts attempts, const BatchState& state);

/// Resolves each attempt, one after the other, as if each were written before the next one is read.
/// \param state      of the acceptable ones all that BatchState names.
/// \param max_paths  of a robot and task; 0: no cap.
BatchChanges resolve_reports(PreparedAttempts attempts, BatchState state, std::uint64_t max_paths,
                             std::int64_t now_ms);

}  // namespace kinship::store
