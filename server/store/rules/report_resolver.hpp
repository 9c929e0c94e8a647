#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/store/rules/batch_changes.hpp"
#include "server/store/rules/batch_state.hpp"

/// The rules of reports, for every engine: when a report is a retry, when its path is kept, and its
/// receipt. Values in, values out.
///
/// A cap keeps the paths with the smallest content digests of a robot and task. Digests of distinct
/// paths are as good as drawn at random, so these are a random sample without replacement of all
/// reported paths (bottom-k: Cohen and Kaplan, 2007), and the same sample for every order of the
/// reports and choice of servers.
namespace kinship::store {

/// Maximum paths of a robot and task that one report drops; each is written anew. After the cap was
/// lowered the next reports drop the rest.
inline constexpr std::uint64_t kMaxDroppedAtOnce = 64;

/// Whether a report is the same as an earlier one. The name of its machine may differ: with
/// security it is the name in the certificate, without it the client's own.
bool is_again(const PreparedAttempt& prepared, const EarlierReport& earlier);

/// The receipt of a report that changes nothing: its UUID is another report's, its robot is not
/// registered, or its path has another number of joints. Nothing: it is acceptable.
/// \param state  robots and reports (body and machine) are enough.
std::optional<Receipt> refusal_of(const PreparedAttempt& prepared, const BatchState& state);

/// The robot and task of an acceptable report; of one that came before, those of its attempt.
PairName pair_name(const PreparedAttempt& prepared, const BatchState& state);

/// The attempts without the refused ones.
std::vector<const PreparedAttempt*> acceptable(PreparedAttempts attempts, const BatchState& state);

/// Resolves the attempts one after the other, as if each were written before the next is read.
/// \param state      all parts of BatchState, for the acceptable attempts.
/// \param max_paths  of a robot and task; 0: no cap.
BatchChanges resolve_reports(PreparedAttempts attempts, BatchState state, std::uint64_t max_paths,
                             std::int64_t now_ms);

}  // namespace kinship::store
