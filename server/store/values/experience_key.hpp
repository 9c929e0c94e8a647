#pragma once

#include <compare>
#include <cstdint>

namespace kinship::store {

/// The internal ids of a robot and a task.
struct ExperienceKey {
  std::int64_t task_id = 0;
  std::int64_t robot_id = 0;

  auto operator<=>(const ExperienceKey&) const = default;
};

}  // namespace kinship::store
