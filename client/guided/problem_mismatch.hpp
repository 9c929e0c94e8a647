#pragma once

#include <optional>
#include <string>

#include "proto/types/problem.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::planner {

/// Why a problem is not one of a robot.
struct Mismatch {
  NotPlanned kind = NotPlanned::DofMismatch;
  std::string text;  ///< for people
};

/// Other joints, a start or goal beyond a limit. Limits hold to the rounding of a few digits.
std::optional<Mismatch> find_mismatch(const kinematics::Chain& chain, const Problem& problem);

}  // namespace kinship::planner
