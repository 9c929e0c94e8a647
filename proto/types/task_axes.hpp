#pragma once

#include <array>
#include <cstddef>

namespace kinship {

/// Which coordinates of the transfer frame's pose matter to a robot's tasks: x, y, z, roll,
/// pitch, yaw in the base link. A planar arm has x, y and yaw.
struct TaskAxes {
  std::array<bool, 6> matters = {true, true, true, true, true, true};

  bool operator==(const TaskAxes&) const = default;

  bool all() const {
    for (const bool axis : matters)
      if (!axis) return false;
    return true;
  }
};

}  // namespace kinship
