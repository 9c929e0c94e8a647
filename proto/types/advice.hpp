#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace kinship {

/// What the attempts of one arm of a (task, robot) cost. An attempt that did not solve its problem
/// is censored: its checks count, it adds no solution.
struct ArmEvidence {
  std::uint64_t attempts = 0;
  std::uint64_t solved = 0;
  double checks_per_solution = 0;  ///< all checks of the arm / solved; 0 if none was solved

  bool operator==(const ArmEvidence&) const = default;
};

/// What share of guided samples is recommended to a robot for a task, and why.
struct Advice {
  double recommended_share = 0;                ///< 0 to 1
  std::string evidence;                        ///< in words
  std::optional<ArmEvidence> guided, control;  ///< missing: no such attempts
};

}  // namespace kinship
