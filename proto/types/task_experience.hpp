#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"

namespace kinship {

/// A way of the transfer frame that a robot took from a start to a goal.
struct PosePath {
  Digest source;  ///< the robot
  Uuid path;      ///< the uuid of the report that brought it
  /// Of the transfer frame in the task frame (that of the robot's base if its placement was not
  /// said), m: start first, goal last, at equal parts of the path's length in joint space.
  std::vector<Eigen::Isometry3d> poses;
};

/// The ways of a task, chosen so that they cover starts and goals: for any robot, placement and
/// query. The first few are such a choice again.
struct TaskExperience {
  /// Of the choice: another one has another revision, in one epoch of the store. Never 0.
  std::uint64_t revision = 0;
  std::uint64_t paths_known = 0;  ///< of the selection, stored and usable: these were chosen from
  std::vector<PosePath> paths;
};

inline constexpr int kExperiencePoses = 40;  ///< that the server gives a path
inline constexpr std::size_t kMaxExperiencePaths = 4096;
inline constexpr std::size_t kMinPosesOfPath = 2;
inline constexpr std::size_t kMaxPosesOfPath = 256;
inline constexpr std::uint32_t kDefaultExperienceBytes = 256 * 1024;
inline constexpr std::uint32_t kMaxExperienceBytes = 1024 * 1024;

/// What a path of so many poses counts of the bytes that a fetch allows.
constexpr std::size_t experience_bytes(std::size_t poses) {
  constexpr std::size_t kBytesOfPath = 96, kBytesOfPose = 7 * sizeof(float);
  return kBytesOfPath + kBytesOfPose * poses;
}

}  // namespace kinship
