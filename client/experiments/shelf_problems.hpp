#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <string_view>

#include "proto/types/problem.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::experiments {

/// Pose of a robot's base in the task frame from which the shelf task is comfortable: known for
/// the robots of robots/models, identity for others.
Eigen::Isometry3d shelf_placement(std::string_view label);

/// One planning problem of the shelf task: the robot holds the box above the table in a random
/// free configuration, the goal is a pose of the transfer frame in a compartment.
///
/// The scene, the pick and the goal pose depend on seed and index only, so that robots can be
/// compared; the start is the robot's own. Where the robot has no free start or no free goal, the
/// instance is drawn again with the next sub-seed, and its name ends in ".1", ".2" and so on:
/// equal names, equal scenes.
/// \throws Failure(NotFound) if no draw out of kMaxDraws can be done by the robot.
Problem draw_shelf_problem(const models::LoadedRobot& robot, const Eigen::Isometry3d& T_task_base,
                           std::uint64_t seed, std::uint32_t index);

inline constexpr std::uint32_t kMaxDraws = 50;

}  // namespace kinship::experiments
