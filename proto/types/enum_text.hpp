#pragma once

#include <string_view>

#include "proto/types/attempt.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/result.hpp"

/// The words for enumerators wherever people or files see them: lower case, stable.
namespace kinship {

std::string_view to_text(Outcome outcome);          ///< solved, timeout, failed
std::string_view to_text(Arm arm);                  ///< guided, control, uniform
std::string_view to_text(DistributionState state);  ///< ready, failed

/// Each returns the enumerator, or InvalidInput that lists the allowed words.
Result<Outcome> parse_outcome(std::string_view text);
Result<Arm> parse_arm(std::string_view text);
Result<DistributionState> parse_distribution_state(std::string_view text);

}  // namespace kinship
