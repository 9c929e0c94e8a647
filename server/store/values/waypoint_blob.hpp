#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "proto/types/path.hpp"

namespace kinship::store {

/// Encoding of waypoints in the database; the numbers are part of the schema.
enum class WaypointEncoding : std::uint8_t {
  Raw = 1,   ///< float64 little-endian, column-major dof x n
  Delta = 2  ///< the same without loss: differences of bit patterns, bytes shuffled, zstd
};

/// Waypoints as a blob, with the values needed to decode it.
struct WaypointBlob {
  std::int64_t dof = 0;
  std::int64_t waypoint_count = 0;
  WaypointEncoding encoding = WaypointEncoding::Raw;
  std::vector<std::uint8_t> bytes;
};

/// \param waypoints  dof x n, one column per waypoint, joint units.
/// \return the smaller of the two encodings; both keep every bit.
WaypointBlob encode_waypoints(const Eigen::MatrixXd& waypoints);

/// \return empty if the blob is no result of encode_waypoints: a size over the limits, the wrong
///         length, bad compression, a value that is not finite.
std::optional<Path> decode_waypoints(std::int64_t dof, std::int64_t waypoint_count,
                                     std::int64_t encoding, std::span<const std::uint8_t> bytes);

}  // namespace kinship::store
