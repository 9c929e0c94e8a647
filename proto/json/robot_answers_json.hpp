#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "proto/types/conversations.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_check.hpp"
#include "proto/types/robot_links.hpp"
#include "proto/types/transferability.hpp"

/// Output and input of `robots register`, `check`, `fk`, `ik`, `links`, `frames` and `compare`.
namespace kinship::json {

std::string to_json(const InverseAnswer& answer);  ///< reason null if there are solutions
std::string to_json(const RobotCheck& check);

std::string to_json(const ForwardAnswer& answer);

/// `robots compare`: {"task": ..., "rows": [...]}, one row per pair; worth is by time, by checks if
/// no time is known, null without either.
std::string to_json(const std::string& task, const std::vector<Transferability>& pairs);

std::string to_json(const RobotLinks& links);
std::string to_json(const RobotFrames& frames);
std::string to_json(const SrdfSuggestion& suggestion);

/// `robots register`.
std::string to_json(const RegisterReply& reply, const std::string& label);

/// A line [x, y, z, qx, qy, qz, qw].
/// \return the pose, or InvalidInput that names the fault.
Result<Eigen::Isometry3d> pose_from_json(std::string_view text);

/// A line [q_1, q_2, ...] of at most kMaxDof numbers, joint units.
Result<Eigen::VectorXd> configuration_from_json(std::string_view text);

}  // namespace kinship::json
