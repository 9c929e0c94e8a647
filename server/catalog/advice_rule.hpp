#pragma once

#include "proto/types/advice.hpp"
#include "server/catalog/judged_attempts.hpp"
#include "server/store/store.hpp"

namespace kinship::catalog {

/// With fewer attempts than this in either sampling mode the profile decides on the share.
inline constexpr std::uint64_t kMinAttempts = 10;

/// What the attempts of a robot and task recommend.
///
/// `judged` is what guidance of the distribution's own engines and profile is judged from; `totals`
/// are of all attempts and only told.
///
/// A client that samples per query gets `recent` and `guided_share`, which is `profile_share`, and
/// decides itself. One that plans every query alike gets `recommended_share`, from the same belief
/// about ratio = cost of a uniform query / cost of a guided one (evidence::compare_costs), with p =
/// the probability that guidance is cheaper:
///
///     a mode has fewer than kMinAttempts or reports no checks: profile_share
///     else: profile_share x (p - 0.4) / 0.3, between 0 and profile_share
///
/// A share between is only for what is open: who waited for p = 0.95 would plan worse for as long,
/// whichever mode it is. So the share moves without a jump and does not depend on how fast a
/// planner checks (all checks times any factor change nothing).
///
/// \param profile_share  0 to 1.
Advice advise(const store::AttemptTotals& totals, JudgedAttempts judged, double profile_share);

}  // namespace kinship::catalog
