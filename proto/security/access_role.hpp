#pragma once

#include <span>
#include <string>
#include <string_view>

#include "proto/types/caller.hpp"
#include "proto/types/result.hpp"

namespace kinship::security {

/// "robot", "reader", "operator" or "admin".
std::string role_name(AccessRole role);

/// \return the role, or an error that may suggest a correction.
Result<AccessRole> read_role(std::string_view name);

/// All names, from the role with the fewest rights to the one with all.
std::span<const std::string> role_names();

}  // namespace kinship::security
