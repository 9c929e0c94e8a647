#pragma once

#include "proto/types/advice.hpp"
#include "proto/types/profile.hpp"

namespace kinship::service {

/// What a profile recommends before attempts have taught better.
Advice advice_of_profile(const Profile& profile);

/// Without a mixture there is nothing to draw guided samples from.
Advice advice_without_mixture();

}  // namespace kinship::service
