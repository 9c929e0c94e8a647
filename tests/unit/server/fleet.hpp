#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/robot_description.hpp"
#include "robots/kinematics/urdf.hpp"
#include "server/runtime/robot_registry.hpp"

/// Small planar robots and what they report.
namespace kinship::fleet {

inline constexpr double kLimit_rad = 2.8;

/// Revolute joints j1, j2, ... about z, one link length apart; its task is place and heading.
inline RobotDescription planar(const std::string& label, const std::vector<double>& lengths_m) {
  std::string urdf = "<robot name='planar'><link name='base'/>";
  std::string parent = "base";
  double offset_m = 0;
  const auto add = [&](const std::string& joint, const std::string& child,
                       const std::string& rest) {
    urdf += "<link name='" + child + "'/><joint name='" + joint + "' " + rest + "<parent link='" +
            parent + "'/><child link='" + child + "'/><origin xyz='" + std::to_string(offset_m) +
            " 0 0'/></joint>";
    parent = child;
  };
  const std::string limit = std::to_string(kLimit_rad);
  std::string motion = "type='revolute'><axis xyz='0 0 1'/><limit lower='-";
  motion.append(limit).append("' upper='").append(limit).append("' effort='1' velocity='1'/>");
  for (std::size_t i = 0; i < lengths_m.size(); ++i) {
    const std::string number = std::to_string(i + 1);
    add("j" + number, "link" + number, motion);
    offset_m = lengths_m[i];
  }
  add("tip_joint", "tip", "type='fixed'>");
  RobotDescription description;
  description.label = label;
  description.urdf = urdf + "</robot>";
  description.base_link = "base";
  description.tip_link = "tip";
  description.task_axes.matters = {true, true, false, false, false, true};
  return description;
}

/// With a shape on its first link, as the element of the URDF.
inline RobotDescription with_shape(RobotDescription description, const std::string& geometry) {
  const std::string link = "<link name='link1'/>";
  description.urdf.replace(
      description.urdf.find(link), link.size(),
      "<link name='link1'><collision><geometry>" + geometry + "</geometry></collision></link>");
  return description;
}

inline RobotDescription teacher() { return planar("teacher", {0.4, 0.3, 0.2}); }
inline RobotDescription pupil() { return planar("pupil", {0.35, 0.3, 0.2, 0.1}); }
/// So short that it reaches nothing of what the teacher does.
inline RobotDescription dwarf() { return planar("dwarf", {0.02, 0.02, 0.02}); }

inline kinematics::Chain chain_of(const RobotDescription& description) {
  return kinematics::read_chain(description).value_or_throw();
}

inline runtime::Robot robot_of(const RobotDescription& description) {
  kinematics::Chain chain = chain_of(description);
  const Digest digest = chain.digest();
  return {digest, description.label, std::move(chain)};
}

/// A bent path inside the limits, its tip well within reach of teacher and pupil.
inline Path path(Eigen::Index dof, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> noise(-0.2, 0.2);
  Eigen::MatrixXd waypoints(dof, 4);
  for (Eigen::Index i = 0; i < waypoints.cols(); ++i)
    for (Eigen::Index j = 0; j < dof; ++j)
      waypoints(j, i) = (j == 0 ? -0.6 : 0.7) + 0.4 * static_cast<double>(i) * (j == 1 ? -1 : 1) +
                        noise(generator);
  return Path(waypoints);
}

inline Attempt unsolved(const Digest& robot, const std::string& task) {
  Attempt attempt;
  attempt.report_uuid = Uuid::random();
  attempt.robot = robot;
  attempt.machine = "cell 1";
  attempt.task = task;
  attempt.record.outcome = Outcome::Timeout;
  attempt.record.planner = "birrt";
  attempt.record.planning_time_s = 1.5;
  attempt.record.time_limit_s = 2;
  return attempt;
}

inline Attempt solved(const runtime::Robot& robot, const std::string& task, std::uint64_t seed) {
  Attempt attempt = unsolved(robot.digest, task);
  attempt.record.outcome = Outcome::Solved;
  attempt.path = path(robot.chain.dof(), seed);
  return attempt;
}

/// `count` attempts with different paths.
inline std::vector<Attempt> solved(const runtime::Robot& robot, const std::string& task, int count,
                                   std::uint64_t first_seed) {
  std::vector<Attempt> attempts;
  attempts.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    attempts.push_back(solved(robot, task, first_seed + static_cast<std::uint64_t>(i)));
  return attempts;
}

/// Who asks on the server's machine, without security.
inline Caller caller_here() { return {.role = AccessRole::Admin, .is_local = true}; }

inline AdminRequest question(AdminVerb verb, const std::string& argument = "") {
  AdminRequest request;
  request.verb = verb;
  request.argument = argument;
  return request;
}

}  // namespace kinship::fleet
