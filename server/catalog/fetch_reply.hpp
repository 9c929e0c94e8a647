#pragma once

#include <string>

#include "proto/types/conversations.hpp"
#include "server/catalog/pending_fit.hpp"
#include "server/fitting/distribution_key.hpp"

namespace kinship::catalog {

/// Pending, NoExperience, UnknownRobot, Busy or Refused, and why.
FetchReply without_distribution(FetchStatus status, const std::string& message);

/// NoExperience, and of what.
FetchReply no_experience(const fitting::DistributionKey& key);

SharedReply shared(FetchReply reply);
SharedReply shared_pending();

/// Ready or Failed, as the distribution says.
SharedReply with_distribution(Distribution distribution);

/// `done`, called with a distribution whose profile is called what its caller calls it: texts of
/// equal values have one distribution between them.
FetchDone with_profile_text_of(const FetchRequest& request, FetchDone done);

}  // namespace kinship::catalog
