#pragma once

#include <string>

#include "proto/types/conversations.hpp"
#include "server/catalog/pending_fit.hpp"
#include "server/fitting/distribution_key.hpp"

namespace kinship::catalog {

/// Pending, NoExperience, UnknownRobot, Busy or Refused, with the reason.
FetchReply without_distribution(FetchStatus status, const std::string& message);

/// NoExperience, with the task and selection. \param advice  that ends the message.
FetchReply no_experience(const fitting::DistributionKey& key, const std::string& advice = {});

SharedReply shared(FetchReply reply);
SharedReply shared_pending();

/// Ready or Failed, by the distribution's state.
SharedReply with_distribution(Distribution distribution);

/// `done` with the profile text of the request in the distribution: profile texts of equal values
/// share one distribution.
FetchDone with_profile_text_of(const FetchRequest& request, FetchDone done);

}  // namespace kinship::catalog
