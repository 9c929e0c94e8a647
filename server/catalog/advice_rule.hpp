#pragma once

#include "proto/types/advice.hpp"
#include "server/catalog/judged_attempts.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::catalog {

/// With fewer attempts in either sampling mode the profile's share is recommended.
inline constexpr std::uint64_t kMinAttempts = 10;

/// The recommendation from the attempts of a robot and task.
///
/// `judged` has the attempts that guidance of the distribution's own engines and profile is judged
/// from; `totals` are of all attempts and only reported.
///
/// A client that chooses the mode per query gets `recent` and `guided_share`, which is
/// `profile_share`, and decides itself. A client that plans every query alike gets
/// `recommended_share`, from the same belief about ratio = cost of a uniform query / cost of a
/// guided one (evidence::compare_costs), with p = the probability that guidance is cheaper:
///
///     a mode has fewer than kMinAttempts or reports no cost: profile_share
///     else: profile_share x (p - 0.4) / 0.3, between 0 and profile_share
///
/// A share between the two is for the undecided case: a rule that waits for p = 0.95 would plan
/// worse until then, in either mode. The share moves without a jump and does not depend on the
/// speed of a planner or a machine (a factor on all costs changes nothing).
///
/// \param profile_share  0 to 1.
Advice advise(const store::AttemptTotals& totals, JudgedAttempts judged, double profile_share);

}  // namespace kinship::catalog
