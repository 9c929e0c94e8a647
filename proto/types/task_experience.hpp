#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"

namespace kinship {

/// The poses of the transfer frame along a robot's path from a start to a goal.
struct PosePath {
  Digest source;  ///< the robot
  Uuid path;      ///< the UUID of its report
  /// Of the transfer frame in the task frame (in the robot's base link if its placement is
  /// missing), m: start first, goal last, at equal parts of the path's length in joint space.
  std::vector<Eigen::Isometry3d> poses;
};

/// Pose paths of a task, chosen so that they cover starts and goals: for any robot, placement and
/// query. Every prefix is such a choice, too.
struct TaskExperience {
  /// Of the choice: another choice has another revision, within an epoch of the store. Never 0.
  std::uint64_t revision = 0;
  std::uint64_t paths_known = 0;  ///< usable stored paths of the selection, to choose from
  std::vector<PosePath> paths;
};

inline constexpr int kExperiencePoses = 40;  ///< per path, from the server
inline constexpr std::size_t kMaxExperiencePaths = 4096;
inline constexpr std::size_t kMinPosesOfPath = 2;
inline constexpr std::size_t kMaxPosesOfPath = 256;
inline constexpr std::uint32_t kDefaultExperienceBytes = 256 * 1024;
inline constexpr std::uint32_t kMaxExperienceBytes = 1024 * 1024;

/// Bytes of a path of `poses` poses that count against the limit of a fetch.
constexpr std::size_t experience_bytes(std::size_t poses) {
  constexpr std::size_t kBytesOfPath = 96, kBytesOfPose = 7 * sizeof(float);
  return kBytesOfPath + kBytesOfPose * poses;
}

}  // namespace kinship
