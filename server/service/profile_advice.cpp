#include "server/service/profile_advice.hpp"

namespace kinship::service {

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

}  // namespace kinship::service
