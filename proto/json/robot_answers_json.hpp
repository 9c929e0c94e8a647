#pragma once

#include <string>
#include <string_view>

#include "proto/types/conversations.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_check.hpp"

/// What `robots register`, `check` and `ik` print and read.
namespace kinship::json {

std::string to_json(const InverseAnswer& answer);  ///< reason null if there are solutions
std::string to_json(const RobotCheck& check);

/// `robots register`.
std::string to_json(const RegisterReply& reply, const std::string& label);

/// A line [x, y, z, qx, qy, qz, qw].
/// \return the pose, or InvalidInput that names what is wrong.
Result<Eigen::Isometry3d> pose_from_json(std::string_view text);

}  // namespace kinship::json
