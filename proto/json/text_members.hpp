#pragma once

#include <map>
#include <string>
#include <string_view>

#include "proto/types/result.hpp"

namespace kinship::json {

/// An object of texts, at most 16, each of at most kMaxTaskBytes.
Result<std::map<std::string, std::string>> text_members_from_json(std::string_view text);

}  // namespace kinship::json
