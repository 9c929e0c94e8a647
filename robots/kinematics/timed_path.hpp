#pragma once

#include <Eigen/Core>
#include <chrono>
#include <vector>

#include "proto/types/path.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::kinematics {

/// Configurations along a path with plausible times, which a path itself lacks.
struct TimedPath {
  Eigen::MatrixXd configurations;  ///< dof x n, joint units: each waypoint, and between
  std::vector<std::chrono::nanoseconds> times;  ///< n, from 0 on, each after the one before
};

/// Speeds for timed(): the velocity limits of the URDF, 1 rad/s or 0.25 m/s where it has none. dof,
/// joint units per second.
Eigen::VectorXd path_speeds(const RobotModel& robot);

/// Every segment lasts as long as its slowest joint needs at its highest speed, without
/// acceleration, of which a URDF says nothing; a waypoint that repeats the one before is left out.
/// \param speeds    dof, above 0, joint units per second.
/// \param per_second  configurations at least; 0: the waypoints alone.
/// \throws std::invalid_argument if the numbers of joints differ.
TimedPath timed(const Path& path, const Eigen::Ref<const Eigen::VectorXd>& speeds,
                double per_second);

}  // namespace kinship::kinematics
