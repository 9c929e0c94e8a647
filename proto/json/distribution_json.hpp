#pragma once

#include <string>
#include <string_view>

#include "proto/types/distribution.hpp"
#include "proto/types/result.hpp"

namespace kinship::json {

/// The document of `distributions fetch --json`. Weights, means and covariances are null if the
/// distribution has no mixture.
std::string to_json(const Distribution& distribution);

/// \return the distribution, or InvalidInput or TooLarge that names field, value and limit. Doubles
///         of mixture, limits and times are restored bit by bit.
Result<Distribution> distribution_from_json(std::string_view text);

}  // namespace kinship::json
