#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "proto/types/result.hpp"

namespace kinship {

/// Which coordinates of the transfer frame's pose matter to a robot's tasks: x, y, z, roll,
/// pitch, yaw in the base link. A planar arm has x, y and yaw.
struct TaskAxes {
  std::array<bool, 6> matters = {true, true, true, true, true, true};

  bool operator==(const TaskAxes&) const = default;

  bool all() const {
    for (const bool axis : matters)
      if (!axis)
        return false;
    return true;
  }
};

inline constexpr std::array<std::string_view, 6> kTaskAxisNames = {"x",    "y",     "z",
                                                                   "roll", "pitch", "yaw"};

/// The axes that `names` lists.
/// \return InvalidInput if `names` is empty, or with the word that is not an axis.
Result<TaskAxes> parse_task_axes(const std::vector<std::string_view>& names);

}  // namespace kinship
