#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "client/experiments/page/hand_poses.hpp"
#include "client/experiments/page/run_files.hpp"
#include "client/page/bones.hpp"
#include "proto/types/problem.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::experiments {

/// A robot and what it holds at one place of a path.
struct Frame {
  std::vector<page::Bone> bones;
  std::vector<SceneObject> held;
};

/// One path, as a page plays it.
struct Demonstration {
  std::string problem;
  std::uint64_t checks = 0;  ///< collision checks that finding it took
  std::vector<SceneObject> obstacles;
  Poses way;                  ///< of the hand
  std::vector<Frame> frames;  ///< from start to goal, about equally far apart
};

/// \param waypoints  dof x n, of the robot.
Demonstration demonstrate(const models::LoadedRobot& robot, const Problem& problem,
                          const Eigen::MatrixXd& waypoints, std::uint64_t checks);

/// What a robot of the fleet did.
struct FleetMember {
  std::string label;
  std::size_t problems = 0;
  std::vector<Poses> paths;  ///< resampled
  /// Of the solved problem with the median number of checks; no frames if none was solved.
  Demonstration example;
};

/// \throws Failure that names the file if one is missing, broken or another robot's.
FleetMember read_member(const TeacherFiles& files);

}  // namespace kinship::experiments
