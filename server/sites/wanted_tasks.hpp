#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kinship::sites {

/// Whether a name matches a pattern: `*` stands for any characters, `?` for one.
bool matches(std::string_view pattern, std::string_view name);

/// Whether a name matches one of the patterns.
bool matches_any(const std::vector<std::string>& patterns, std::string_view name);

}  // namespace kinship::sites
