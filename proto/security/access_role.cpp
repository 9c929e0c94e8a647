#include "proto/security/access_role.hpp"

#include <algorithm>
#include <vector>

#include "proto/types/enum_text.hpp"
#include "proto/types/nearest_name.hpp"

namespace kinship::security {

std::span<const std::string> role_names() {
  static const std::vector<std::string> names(Words<AccessRole>::kWords.begin(),
                                              Words<AccessRole>::kWords.end());
  return names;
}

std::string role_name(AccessRole role) { return std::string(to_text(role)); }

Result<AccessRole> read_role(std::string_view name) {
  const auto names = role_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    return invalid_input("role '" + std::string(name) +
                         "' is not one of robot, reader, operator, admin" +
                         suggestion(name, names));
  return static_cast<AccessRole>(found - names.begin());
}

}  // namespace kinship::security
