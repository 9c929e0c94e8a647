#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pages/plots/look_up.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/scene.hpp"
#include "proto/types/summaries.hpp"
#include "proto/types/uuid.hpp"

/// The experience of a task in space: paths as ways of the hand, over the scenes recorded with
/// them.
namespace kinship::plots {

/// Bounds of the picture: 2000 ways are some 34 000 segments and 0.8 MB of text (0.3 MB zipped).
inline constexpr std::size_t kMaxTaskPaths = 2000;    ///< the newest
inline constexpr std::size_t kMaxTaskScenes = 24;     ///< those of most paths ...
inline constexpr std::size_t kMaxTaskObjects = 4096;  ///< ... whose objects are so many together
inline constexpr double kWayTolerance_m = 0.002;      ///< of points that are left out of a way

struct TaskPath {
  PathSummary summary;
  std::size_t robot = 0;  ///< in TaskPaths::robots
  Eigen::Matrix3Xd hand;  ///< origin of the transfer frame in the task frame, m
  std::optional<std::size_t>
      scene;  ///< in TaskPaths::scenes; none: not recorded, or not among them
};

struct TaskScene {
  std::vector<SceneObject> objects;
  std::uint64_t paths = 0;  ///< recorded in it
};

/// A robot of the task, in the configuration in which its newest path begins.
struct TaskArm {
  Digest robot;
  std::string label;
  Eigen::Matrix3Xd arm;  ///< origins of base, joints and transfer frame in the task frame, m
};

struct TaskPaths {
  std::uint64_t in_use = 0;        ///< paths of the task, drawn or not
  std::vector<TaskArm> robots;     ///< by label
  std::vector<TaskPath> paths;     ///< in the order of arrival
  std::vector<TaskScene> scenes;   ///< those of most paths first
  std::uint64_t scenes_known = 0;  ///< different ones, recorded with `paths`
  std::uint64_t left_out = 0;      ///< could not be read, or their robot could not
};

/// The newest paths in use, with the robots and scenes that they need.
/// \throws Failure of LookUp::paths.
TaskPaths task_paths(const TaskSummary& task, const LookUp& look_up);

/// The columns of `way` to keep so that each of the others is within the tolerance of the line
/// between its neighbours among those: first and last, then the farthest, and so on.
/// \param way  3 x n, n >= 1, m.
/// Source: Douglas and Peucker, Cartographica 10 (1973).
std::vector<Eigen::Index> simplified(const Eigen::Matrix3Xd& way, double tolerance_m);

std::string to_json(const TaskPaths& paths);

}  // namespace kinship::plots
