#include "proto/types/task_axes.hpp"

#include <algorithm>
#include <string>

namespace kinship {

Result<TaskAxes> parse_task_axes(const std::vector<std::string_view>& names) {
  if (names.empty())
    return Error{ErrorCode::InvalidInput, "names none of x, y, z, roll, pitch, yaw"};
  TaskAxes axes;
  axes.matters.fill(false);
  for (const std::string_view name : names) {
    const auto* const known = std::find(kTaskAxisNames.begin(), kTaskAxisNames.end(), name);
    if (known == kTaskAxisNames.end())
      return Error{ErrorCode::InvalidInput,
                   "'" + std::string(name) + "' is not one of x, y, z, roll, pitch, yaw"};
    axes.matters[static_cast<std::size_t>(known - kTaskAxisNames.begin())] = true;
  }
  return axes;
}

}  // namespace kinship
