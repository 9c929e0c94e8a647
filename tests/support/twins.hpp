#pragma once

#include <cstdint>
#include <string>

#include "proto/types/robot_description.hpp"

namespace kinship::test {

/// The same arm as it comes from a calibration: every number of a joint's origin moved by up to
/// `size` (m and rad), which makes it another robot. 0: only the label differs.
RobotDescription calibrated_twin(RobotDescription robot, const std::string& label, double size,
                                 std::uint64_t seed);

/// The same arm with the limits of all revolute joints set to +-limit_rad.
RobotDescription limited_twin(RobotDescription robot, const std::string& label, double limit_rad);

}  // namespace kinship::test
