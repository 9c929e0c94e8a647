#pragma once

#include <span>
#include <string>
#include <string_view>

#include "proto/types/caller.hpp"
#include "proto/types/result.hpp"

namespace kinship::security {

/// "robot", "reader", "operator" or "admin".
std::string role_name(AccessRole role);

/// \return the role, or an error that says what was meant, maybe.
Result<AccessRole> read_role(std::string_view name);

/// All names, from who may do least to who may do everything.
std::span<const std::string> role_names();

}  // namespace kinship::security
