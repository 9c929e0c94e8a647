#include "server/sites/wanted_tasks.hpp"

#include <fnmatch.h>

#include <algorithm>

namespace kinship::sites {

bool matches(std::string_view pattern, std::string_view name) {
  return fnmatch(std::string(pattern).c_str(), std::string(name).c_str(), FNM_NOESCAPE) == 0;
}

bool matches_any(const std::vector<std::string>& patterns, std::string_view name) {
  return std::ranges::any_of(patterns,
                             [name](const std::string& pattern) { return matches(pattern, name); });
}

}  // namespace kinship::sites
