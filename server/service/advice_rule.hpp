#pragma once

#include "proto/types/advice.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// Fewer attempts than this in either arm teach nothing yet.
inline constexpr std::uint64_t kLeastAttempts = 10;

/// What share of guided samples the attempts of a robot and task recommend.
///
/// The cost of an arm is all its collision checks / its solutions: an unsolved attempt is censored,
/// so its checks count and it adds no solution; an arm that solved nothing counts as half a
/// solution. From the costs follows ratio = guided / control with its 90 % interval [lo, hi]:
/// log(ratio) is taken as normal; its variance is the sum of both arms', each by the delta method
/// for a ratio of two correlated means:
///
///     var(log cost) = (cv(checks)^2 + cv(solved)^2 - 2 cov(checks, solved) / (means)) / attempts
///
/// with cv = standard deviation / mean over the attempts of the arm.
///
/// | Attempts say | Recommended share |
/// |---|---|
/// | an arm has fewer than kLeastAttempts, or reports no checks | `profile_share` |
/// | hi <= 1: guidance is clearly better | `profile_share` |
/// | lo >= 1: clearly worse | 0 |
/// | otherwise | `profile_share` x the part of [log lo, log hi] that lies below 0 |
///
/// So the share moves without a jump, does not depend on how fast a planner checks (all checks
/// times any factor change nothing), and never grows as guided attempts become dearer by a factor.
/// Clients go on to try guidance with a small part of their attempts at share 0, so that it can
/// recover.
///
/// Source of the variance: Casella and Berger, Statistical Inference (2002), example 5.5.27.
///
/// \param profile_share  0 to 1.
Advice advise(const store::AttemptTotals& totals, double profile_share);

}  // namespace kinship::service
