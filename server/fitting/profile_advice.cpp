#include "server/fitting/profile_advice.hpp"

#include <algorithm>

namespace kinship::fitting {

double first_share(const Profile& profile, DistributionState state) {
  return state == DistributionState::Thin ? std::min(profile.recommended_share, profile.thin_share)
                                          : profile.recommended_share;
}

Advice advice_of_profile(const Profile& profile) {
  Advice advice;
  advice.recommended_share = profile.recommended_share;
  advice.guided_share = profile.recommended_share;
  advice.evidence = "share of profile '" + profile.name + "'; no attempts compared yet";
  return advice;
}

Advice advice_without_mixture() {
  Advice advice;
  advice.evidence = "no mixture";
  return advice;
}

}  // namespace kinship::fitting
