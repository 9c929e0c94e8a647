#pragma once

/// The two arms of the examples: a Panda with experience of the task, and a UR10e without.

#include <fstream>
#include <iterator>
#include <kinship/client.hpp>
#include <random>
#include <stdexcept>
#include <string>

inline std::string read_text(const std::string& file) {
  std::ifstream stream(file);
  if (!stream)
    throw std::runtime_error("cannot read '" + file + "'");
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// \param models  the folder of robots that is installed with Kinship.
inline kinship::RobotDescription panda(const std::string& models) {
  kinship::RobotDescription arm;
  arm.label = "panda";
  arm.urdf = read_text(models + "/panda/robot.urdf");
  arm.base_link = "panda_link0";
  arm.tip_link = "panda_link8";
  arm.T_tip_transfer.translation().z() = 0.06;  // between the fingers, z out of the palm
  arm.T_tip_transfer.rotate(Eigen::AngleAxisd(-M_PI / 4, Eigen::Vector3d::UnitZ()));
  return arm;
}

inline kinship::RobotDescription ur10e(const std::string& models) {
  kinship::RobotDescription arm;
  arm.label = "ur10e";
  arm.urdf = read_text(models + "/ur10e/robot.urdf");
  arm.base_link = "base_link";
  arm.tip_link = "tool0";
  arm.T_tip_transfer.translation().z() = 0.06;
  return arm;
}

/// A sweep of the Panda's hand from right to left, a little different for every seed; it stands for
/// a planner's path.
inline kinship::Path sweep(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> noise(-0.1, 0.1);
  Eigen::MatrixXd waypoints(7, 4);  // rad, one column per waypoint
  for (Eigen::Index i = 0; i < waypoints.cols(); ++i) {
    waypoints.col(i) << -0.9 + 0.6 * static_cast<double>(i), -0.785, 0, -2.2, 0, 1.571, 0.785;
    for (double& q : waypoints.col(i))
      q += noise(generator);
  }
  return kinship::Path(waypoints);
}

/// That sweep as the attempt of a planner.
inline kinship::Attempt sweep_attempt(const kinship::Digest& robot, std::uint64_t seed) {
  kinship::Attempt attempt;
  attempt.report_uuid = kinship::Uuid::random();  // by it a report that is sent twice counts once
  attempt.robot = robot;
  attempt.machine = "cell 3";
  attempt.task = "sweep";
  attempt.T_task_base = Eigen::Isometry3d::Identity();  // where the arm stands at its station
  attempt.record.outcome = kinship::Outcome::Solved;
  attempt.record.planner = "mine";
  attempt.record.planning_time_s = 0.5;
  attempt.record.collision_checks = 1000;
  attempt.record.time_limit_s = 10;
  attempt.path = sweep(seed);
  return attempt;
}
