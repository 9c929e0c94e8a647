#include "server/service/check_attempt.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/number_text.hpp"

namespace kinship::service {
namespace {

using kinematics::Joint;
using kinematics::JointType;

struct Range {
  double lower = 0, upper = 0;
};

Error invalid(std::string message) { return {ErrorCode::InvalidInput, std::move(message)}; }

std::optional<Error> check_seconds(std::string_view what, double seconds) {
  if (std::isfinite(seconds) && seconds >= 0)
    return std::nullopt;
  return invalid(std::string(what) + ": " + number_text(seconds) +
                 " s is not a time of at least 0 s");
}

std::optional<Error> check_record(const PlanningRecord& record) {
  if (auto error = check_planner(record.planner))
    return error;
  if (record.planner_options.size() > kMaxPlannerOptionsBytes)
    return invalid("planner options: " + std::to_string(record.planner_options.size()) +
                   " bytes exceed " + std::to_string(kMaxPlannerOptionsBytes));
  if (auto error = check_seconds("planning time", record.planning_time_s))
    return error;
  if (auto error = check_seconds("time limit", record.time_limit_s))
    return error;
  if (!(record.share >= 0 && record.share <= 1))
    return invalid("share: " + number_text(record.share) + " is not within 0 to 1");
  return std::nullopt;
}

std::optional<Error> check_placement(const std::optional<Eigen::Isometry3d>& T_task_base) {
  if (!T_task_base)
    return std::nullopt;
  if (!T_task_base->matrix().allFinite())
    return invalid("placement: a number is not finite");
  const double largest_m = T_task_base->translation().cwiseAbs().maxCoeff();
  if (largest_m > kMaxPlacement_m)
    return invalid("placement: " + number_text(largest_m) + " m exceeds " +
                   number_text(kMaxPlacement_m) + " m");
  return std::nullopt;
}

/// What a joint may report: a continuous one counts its turns.
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
  if (path.size() > static_cast<Eigen::Index>(kMaxWaypoints))
    return invalid(name + std::to_string(path.size()) + " waypoints exceed " +
                   std::to_string(kMaxWaypoints));
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

std::optional<Error> check_attempt(const Attempt& attempt, const runtime::Robot& robot) {
  if (auto error = check_task(attempt.task))
    return error;
  if (auto error = check_machine(attempt.machine))
    return error;
  if (auto error = check_record(attempt.record))
    return error;
  if (auto error = check_placement(attempt.T_task_base))
    return error;
  if (attempt.scene)
    if (auto error = check_scene(*attempt.scene))
      return error;
  const bool solved = attempt.record.outcome == Outcome::Solved;
  if (solved && !attempt.path)
    return invalid("outcome: solved, but there is no path");
  if (!solved && attempt.path)
    return invalid("outcome: not solved, but there is a path");
  return attempt.path ? check_path(*attempt.path, robot) : std::nullopt;
}

}  // namespace kinship::service
