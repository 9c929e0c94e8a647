#include "robots/kinematics/timed_path.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace kinship::kinematics {

Eigen::VectorXd path_speeds(const RobotModel& robot) {
  constexpr double kOther_rad_per_s = 1, kOther_m_per_s = 0.25;
  Eigen::VectorXd speeds = velocity_limits(robot);
  for (Eigen::Index i = 0; i < speeds.size(); ++i)
    if (speeds(i) == 0)
      speeds(i) = robot.chain.joints()[static_cast<std::size_t>(i)].type == JointType::Prismatic
                      ? kOther_m_per_s
                      : kOther_rad_per_s;
  return speeds;
}

TimedPath timed(const Path& path, const Eigen::Ref<const Eigen::VectorXd>& speeds,
                double per_second) {
  if (speeds.size() != path.dof())
    throw std::invalid_argument("timed: a path of " + std::to_string(path.dof()) +
                                " joints, speeds of " + std::to_string(speeds.size()));
  const Eigen::MatrixXd& waypoints = path.waypoints();
  std::vector<Eigen::VectorXd> configurations = {waypoints.col(0)};
  TimedPath result;
  result.times.emplace_back(0);
  double start_s = 0;
  for (Eigen::Index i = 1; i < path.size(); ++i) {
    const Eigen::VectorXd step = waypoints.col(i) - waypoints.col(i - 1);
    const double duration_s = (step.array() / speeds.array()).abs().maxCoeff();
    const auto parts = std::max(1L, std::lround(std::ceil(duration_s * per_second)));
    for (long part = 1; part <= parts; ++part) {
      const double share = static_cast<double>(part) / static_cast<double>(parts);
      const std::chrono::nanoseconds time(std::llround((start_s + share * duration_s) * 1e9));
      if (time <= result.times.back())
        continue;
      result.times.push_back(time);
      configurations.emplace_back(waypoints.col(i - 1) + share * step);
    }
    start_s += duration_s;
  }
  result.configurations.resize(path.dof(), static_cast<Eigen::Index>(configurations.size()));
  for (std::size_t i = 0; i < configurations.size(); ++i)
    result.configurations.col(static_cast<Eigen::Index>(i)) = configurations[i];
  return result;
}

}  // namespace kinship::kinematics
