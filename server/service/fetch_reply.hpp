#pragma once

#include <string>

#include "proto/types/conversations.hpp"
#include "server/service/flight.hpp"

namespace kinship::service {

/// Pending, NoExperience, UnknownRobot, Busy or Refused, and why.
FetchReply without_distribution(FetchStatus status, const std::string& message);

FetchReply no_experience(const std::string& task);

SharedReply shared(FetchReply reply);
SharedReply shared_pending();

/// Ready or Failed, as the distribution says.
SharedReply with_distribution(Distribution distribution);

}  // namespace kinship::service
