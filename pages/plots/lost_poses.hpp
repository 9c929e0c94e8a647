#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pages/plots/look_up.hpp"
#include "proto/types/distribution.hpp"

/// Poses that a transfer lost, and where. The server keeps their numbers (Source), not the poses:
/// they are computed here from the same paths.
namespace kinship::plots {

/// Bounds of the work, shared evenly by the sources: the newest paths, and poses of them.
inline constexpr std::size_t kMaxSearchedPaths = 200;
inline constexpr std::size_t kMaxSearchedPoses = 3000;

/// Why a robot cannot take a pose; Colliding: every configuration found touches the robot itself or
/// the path's recorded scene.
enum class Loss { OutOfReach, OutsideLimits, NotConverged, Colliding };
inline constexpr std::size_t kLosses = 4;

/// What was searched of the paths of one source.
struct SearchedSource {
  std::string label;
  std::uint64_t paths = 0, poses = 0;
  std::uint64_t taken_over = 0;  ///< paths of the same arm at the same place: no search
  std::array<std::uint64_t, kLosses> lost{};  ///< of `poses`
};

struct LostPoses {
  std::vector<SearchedSource> sources;  ///< one for each source of the distribution, in its order
  /// Origin of the transfer frame in the task frame, m: 3 x n for each reason.
  std::array<Eigen::Matrix3Xd, kLosses> places;
  std::string problem;  ///< why nothing was searched; empty: it was
};

/// Searches the poses of a distribution's paths as transfer does (resampled by its profile, inverse
/// kinematics, self-collision, recorded scenes), without its tracks: a pose that only a track
/// reaches counts as lost.
/// \param target  the distribution's robot.
/// \throws Failure of LookUp::paths.
LostPoses lost_poses(const Distribution& distribution, const DrawnRobot& target,
                     const LookUp& look_up);

/// {"sources": [{"label", "paths", "poses", "taken_over", "lost": [4]}], "places": [4 x [x, y, z,
/// ...]], "problem"}, in the order of Loss.
std::string to_json(const LostPoses& lost);

}  // namespace kinship::plots
