#pragma once

#include "proto/types/advice.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/profile.hpp"

namespace kinship::fitting {

/// The share that a profile recommends for a distribution of this state before attempts have taught
/// better: a thin one has to show its worth first.
double first_share(const Profile& profile, DistributionState state);

/// What a profile recommends before attempts have taught better.
Advice advice_of_profile(const Profile& profile);

/// Without a mixture there is nothing to draw guided samples from.
Advice advice_without_mixture();

}  // namespace kinship::fitting
