#include "server/service/validate_attempt.hpp"

#include <algorithm>
#include <string>

#include "proto/types/limits.hpp"
#include "proto/types/number_text.hpp"

namespace kinship::service {
namespace {

using kinematics::Joint;
using kinematics::JointType;

struct Range {
  double lower = 0, upper = 0;
};

Error invalid(std::string message) { return {ErrorCode::InvalidInput, std::move(message)}; }

/// The values that a joint may report: a continuous one counts its turns.
Range range_of(const Joint& joint) {
  if (joint.type == JointType::Continuous)
    return {-kMaxJointValue, kMaxJointValue};
  return {joint.lower, joint.upper};
}

/// The first waypoint outside the limits of a joint, if there is one.
std::optional<Error> check_joint(const Joint& joint, const Eigen::VectorXd& values,
                                 const std::string& joint_name) {
  const Range range = range_of(joint);
  const auto bad = std::find_if(values.begin(), values.end(), [&range](double value) {
    return value > range.upper + kLimitTolerance || value < range.lower - kLimitTolerance;
  });
  if (bad == values.end())
    return std::nullopt;
  const std::string unit = joint.type == JointType::Prismatic ? " m" : " rad";
  const bool above = *bad > range.upper;
  return invalid(joint_name + " at " + number_text(*bad) + unit +
                 (above ? " exceeds " : " is below ") +
                 number_text(above ? range.upper : range.lower) + unit + ", waypoint " +
                 std::to_string(bad - values.begin() + 1));
}

std::optional<Error> check_path(const Path& path, const runtime::Robot& robot) {
  const std::string name = "robot '" + robot.label + "': ";
  if (path.dof() != robot.chain.dof())
    return invalid(name + "a path of " + std::to_string(path.dof()) + " joints, but it has " +
                   std::to_string(robot.chain.dof()));
  for (Eigen::Index j = 0; j < path.dof(); ++j) {
    const Joint& joint = robot.chain.joints()[static_cast<std::size_t>(j)];
    const std::string joint_name =
        name + "joint " + std::to_string(j + 1) + " '" + joint.name + "'";
    if (auto error = check_joint(joint, path.waypoints().row(j), joint_name))
      return error;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Error> validate(const Attempt& attempt, const runtime::Robot& robot) {
  if (attempt.search) {
    const Eigen::Index dof = dof_of(*attempt.search);
    if (dof != 0 && dof != robot.chain.dof())
      return invalid("robot '" + robot.label + "': a search record of " + std::to_string(dof) +
                     " joints, but it has " + std::to_string(robot.chain.dof()));
  }
  return attempt.path ? check_path(*attempt.path, robot) : std::nullopt;
}

}  // namespace kinship::service
