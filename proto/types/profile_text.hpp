#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "proto/types/profile.hpp"
#include "proto/types/result.hpp"

namespace kinship {

/// Reads a client's profile: a name and the options that differ, separated by commas: `default`,
/// `paper`, `default,components=20,tracks=0`, `default,components=auto`, `default,prior=auto`,
/// `default,estimator=kde` (or gmm). Options are named as the members of TransferParameters and
/// DensityParameters; yes and no are 1 and 0. The text is the profile's name, but its values
/// identify the profile: two texts of equal values are one profile.
/// \return InvalidInput that names option, value and limits.
Result<Profile> profile_from_text(std::string_view text);

/// The options that a text may change.
std::vector<std::string> profile_options();

}  // namespace kinship
