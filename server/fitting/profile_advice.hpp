#pragma once

#include "proto/types/advice.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/profile.hpp"

namespace kinship::fitting {

/// The share that a profile recommends for a distribution of this state before there are attempts:
/// less for a thin one, which is not yet proven.
double first_share(const Profile& profile, DistributionState state);

/// The advice of a profile before there are attempts.
Advice advice_of_profile(const Profile& profile);

/// The advice without a mixture: guided samples cannot be drawn.
Advice advice_without_mixture();

}  // namespace kinship::fitting
