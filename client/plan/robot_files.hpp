#pragma once

#include "client/plan/plan_options.hpp"
#include "client/plan/plan_problem.hpp"
#include "proto/types/robot_description.hpp"

namespace kinship::plan {

/// What is registered at the server, and what planning needs of it.
struct LoadedRobot {
  RobotDescription description;
  PlannedRobot planned;
};

/// \throws Failure if a file cannot be read or does not describe a robot.
LoadedRobot load_robot(const RobotFiles& files);

}  // namespace kinship::plan
