#pragma once

#include "proto/types/advice.hpp"
#include "server/store/store.hpp"

namespace kinship::catalog {

/// With fewer attempts than this in either arm the profile decides on the share.
inline constexpr std::uint64_t kMinAttempts = 10;

/// What the attempts of a robot and task recommend.
///
/// A client that samples per query gets `recent` and `guided_share`, which is `profile_share`, and
/// decides itself. One that plans every query alike gets `recommended_share`, from the same belief
/// about ratio = cost of a guided query / cost of a control one (evidence::compare_costs), with p =
/// the probability that guidance is cheaper:
///
/// | Attempts say | Recommended share |
/// |---|---|
/// | an arm has fewer than kMinAttempts, or none of late, or reports no checks | `profile_share`
/// | | p >= 0.95: clearly better | `profile_share` | | p <= 0.05: clearly worse | 0 | | otherwise |
/// `profile_share` x (p - 0.05) / 0.9 |
///
/// So the share moves without a jump, does not depend on how fast a planner checks (all checks
/// times any factor change nothing), and never grows as guided attempts become dearer by a factor.
///
/// \param profile_share  0 to 1.
Advice advise(const store::AttemptTotals& totals, double profile_share);

}  // namespace kinship::catalog
