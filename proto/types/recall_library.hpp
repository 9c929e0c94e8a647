#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/failure.hpp"
#include "proto/types/uuid.hpp"

namespace kinship {

/// A recorded query as one robot solved it, or its server for it.
struct RecallQuery {
  Uuid report;  ///< that recorded it
  /// The server planned it with this robot's model: no experience of the robot itself.
  bool is_synthetic = false;
  Eigen::Isometry3d T_task_base =
      Eigen::Isometry3d::Identity();              ///< of the robot when it solved it
  Eigen::VectorXd start, goal;                    ///< dof, joint units
  std::vector<Eigen::Isometry3d> T_task_anchors;  ///< of RecallLibrary::anchors
};

/// A whole path to be tried on other queries, planned with clearance.
struct RecallPath {
  std::uint32_t query = 0;  ///< that it solves: index into RecallLibrary::queries
  /// dof x kRecallWaypoints, start first, at equal parts of the path's length in joint space.
  Eigen::MatrixXd waypoints;
};

/// How a path is moved onto a query; see robots/recall/warp.hpp.
struct WarpMode {
  std::uint32_t blend = 0;  ///< how it leaves the query's start, and where its posture turns
  /// The frame that the hand keeps its way in: 0 the goal's, 1 the task frame, 2 and on an anchor.
  std::uint32_t frame = 0;

  bool operator==(const WarpMode&) const = default;
};

inline constexpr std::uint32_t kGoalFrame = 0, kTaskFrame = 1, kFirstAnchor = 2;

/// Paths of one robot for one task that are tried whole, before any search, with what each was
/// worth on the queries of the others. Best first: every prefix of the paths is a library, too.
struct RecallLibrary {
  std::uint64_t revision = 0;  ///< another library has another one; never 0
  double search_checks = 0;    ///< that a search takes, mean of the recorded queries
  double try_checks = 0;       ///< of a search that take as long as a path that does not fit
  /// Names of objects of the recorded scenes that furniture is known by.
  std::vector<std::string> anchors;
  std::vector<RecallQuery> queries;
  std::vector<RecallPath> paths;
  std::vector<WarpMode> modes;
  /// Whether each path in each mode solves each query but its own, with the goal configuration of
  /// that query: one bit each, lowest first, row by row; a row a query, in it the modes of the
  /// first path, then those of the next.
  std::vector<std::uint8_t> solves;
  /// The same with any configuration at the goal's pose, near the one that the path ends in.
  std::vector<std::uint8_t> reaches;

  /// Index of a bit of `solves` and `reaches`.
  std::size_t bit(std::size_t query, std::size_t path, std::size_t mode) const {
    return (query * paths.size() + path) * modes.size() + mode;
  }
};

/// A bit of RecallLibrary::solves.
inline bool bit_of(const std::vector<std::uint8_t>& bits, std::size_t at) {
  return (bits[at / 8] >> (at % 8) & 1U) != 0;
}

inline constexpr int kRecallWaypoints = 32;
inline constexpr std::size_t kMaxRecallQueries = 256, kMaxRecallPaths = 512;
inline constexpr std::size_t kMaxRecallAnchors = 2, kMaxWarpModes = 16;
inline constexpr std::size_t kMaxWarpBlends = 3;

/// The rule that a library breaks, if any: counts within the limits, sizes that agree, indices that
/// exist, finite numbers, proper poses. It begins with "recall".
std::optional<Error> validate(const RecallLibrary& library);

/// Bytes of a library in a message, about.
std::size_t recall_bytes(const RecallLibrary& library);

}  // namespace kinship
